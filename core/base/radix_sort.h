#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace lightcull {

/// Sorts keys below 2^62 that, among those with equal upper halves, are in order already. The
/// result is in `sorted`, which does not overlap `keys`; what is left in `keys` means nothing.
inline void sort_keys(std::uint64_t* keys, std::uint64_t* sorted, std::size_t count) noexcept {
    constexpr std::size_t kDigits = 3, kDigitBits = 10, kBuckets = std::size_t{1} << kDigitBits;
    const auto digit_of = [](std::uint64_t key, std::size_t digit) {
        return static_cast<std::size_t>(key >> (32 + digit * kDigitBits)) & (kBuckets - 1);
    };
    constexpr std::size_t kFew = 192;  // for which the buckets would cost more than they save
    if (count < kFew) {
        std::copy_n(keys, count, sorted);
        std::sort(sorted, sorted + count);
        return;
    }
    std::array<std::array<std::uint32_t, kBuckets>, kDigits> places{};
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t digit = 0; digit < kDigits; ++digit)
            ++places[digit][digit_of(keys[i], digit)];
    }
    for (std::size_t digit = 0; digit < kDigits; ++digit) {
        std::uint32_t sum = 0;
        for (std::uint32_t& place : places[digit]) sum += std::exchange(place, sum);
        for (std::size_t i = 0; i < count; ++i) {
            sorted[places[digit][digit_of(keys[i], digit)]++] = keys[i];
        }
        std::swap(keys, sorted);
    }
}

}  // namespace lightcull
