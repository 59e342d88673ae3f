#include "render/tiles.h"

#include <algorithm>

namespace lightcull {

std::vector<Tile> tiles_of(const Tile& area, std::uint32_t edge) {
    std::vector<Tile> tiles;
    for (std::uint32_t y = area.y0; y < area.y1; y += edge) {
        for (std::uint32_t x = area.x0; x < area.x1; x += edge) {
            tiles.push_back({x, y, std::min(x + edge, area.x1), std::min(y + edge, area.y1)});
        }
    }
    return tiles;
}

}  // namespace lightcull
