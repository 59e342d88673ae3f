#pragma once

#include <cstdint>
#include <vector>

#include "base/core_export.h"

namespace lightcull {

/// The pixels [x0, x1) x [y0, y1).
struct Tile {
    std::uint32_t x0, y0, x1, y1;
};

/// The edge of a tile in pixels: small enough that a few threads share a small image evenly.
inline constexpr std::uint32_t kTileSize = 64;
/// The edge of a region in pixels. A region has as many points as light selection gets at a time,
/// and as many paths as are in memory.
inline constexpr std::uint32_t kRegionSize = 512;

/// Cuts an area into tiles of `edge` pixels, smaller at its right and lower border, row by row.
LIGHTCULL_CORE_EXPORT std::vector<Tile> tiles_of(const Tile& area, std::uint32_t edge);

}  // namespace lightcull
