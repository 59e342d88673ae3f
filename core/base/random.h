#pragma once

#include <cstdint>

/// Counter-based random numbers: a value is a hash of what it is for, so that no state is shared
/// and any order of evaluation gives the same bits.

namespace lightcull {

/// A bijection of 64 bits in which each input bit flips about half of the output bits
/// (Stafford's variant 13 of the MurmurHash3 finaliser).
constexpr std::uint64_t mix(std::uint64_t x) noexcept {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/// A hash of two numbers, in that order.
constexpr std::uint64_t hash(std::uint64_t a, std::uint64_t b) noexcept {
    return mix(mix(a + 0x9e3779b97f4a7c15u) + b);
}
template <typename... More>
constexpr std::uint64_t hash(std::uint64_t a, std::uint64_t b, More... more) noexcept {
    return hash(hash(a, b), more...);
}

/// The upper 24 bits as a float in [0, 1).
constexpr float uniform_float(std::uint64_t bits) noexcept {
    return static_cast<float>(bits >> 40) * 0x1p-24f;
}

/// The upper 53 bits as a double in [0, 1).
constexpr double uniform_double(std::uint64_t bits) noexcept {
    return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// A sequence of uniform numbers of its own for each key.
class RandomStream {
  public:
    constexpr explicit RandomStream(std::uint64_t key) noexcept : key_(key) {}
    constexpr float next() noexcept { return uniform_float(hash(key_, counter_++)); }

  private:
    std::uint64_t key_;
    std::uint64_t counter_ = 0;
};

}  // namespace lightcull
