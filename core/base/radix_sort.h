#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace lightcull {

/// Sorts keys whose upper halves are below 2^(10 kDigits), and that are in order already where
/// their upper halves are equal. `scratch` has room for as many and does not overlap them. Returns
/// whichever of the two has the result, `keys` if kDigits is even; the numbers left in the other
/// mean nothing.
template <std::size_t kDigits>
std::uint64_t* sort_keys(std::uint64_t* keys, std::uint64_t* scratch, std::size_t count) noexcept {
    constexpr std::size_t kDigitBits = 10, kBuckets = std::size_t{1} << kDigitBits;
    const auto digit_of = [](std::uint64_t key, std::size_t digit) {
        return static_cast<std::size_t>(key >> (32 + digit * kDigitBits)) & (kBuckets - 1);
    };
    constexpr std::size_t kFew = 192;  // with fewer keys the buckets would cost more than they save
    if (count < kFew) {
        std::sort(keys, keys + count);
        return keys;
    }
    std::array<std::array<std::uint32_t, kBuckets>, kDigits> places{};
    for (std::size_t i = 0; i < count; ++i) {
        assert(keys[i] >> (32 + kDigits * kDigitBits) == 0);
        for (std::size_t digit = 0; digit < kDigits; ++digit)
            ++places[digit][digit_of(keys[i], digit)];
    }
    for (std::size_t digit = 0; digit < kDigits; ++digit) {
        std::uint32_t sum = 0;
        for (std::uint32_t& place : places[digit]) sum += std::exchange(place, sum);
        for (std::size_t i = 0; i < count; ++i) {
            scratch[places[digit][digit_of(keys[i], digit)]++] = keys[i];
        }
        std::swap(keys, scratch);
    }
    return keys;
}

}  // namespace lightcull
