#pragma once

#include <cstdint>

namespace lightcull {

/// The place of a cell on a Morton curve through a grid of 1024 cells a side: the bits of x, y and
/// z in turn. Each of x, y and z is below 1024.
constexpr std::uint32_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) noexcept {
    const auto spread = [](std::uint32_t bits) {
        bits = (bits | (bits << 16)) & 0x030000ffu;
        bits = (bits | (bits << 8)) & 0x0300f00fu;
        bits = (bits | (bits << 4)) & 0x030c30c3u;
        return (bits | (bits << 2)) & 0x09249249u;
    };
    return spread(x) | (spread(y) << 1) | (spread(z) << 2);
}

}  // namespace lightcull
