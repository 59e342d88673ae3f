#pragma once

#include <cstdint>

namespace lightcull {

/// The finaliser of MurmurHash3 for 32 bits: arithmetic that every vector unit and GPU has.
constexpr std::uint32_t scramble(std::uint32_t x) noexcept {
    x = (x ^ (x >> 16)) * 0x85ebca6bu;
    x = (x ^ (x >> 13)) * 0xc2b2ae35u;
    return x ^ (x >> 16);
}

}  // namespace lightcull
