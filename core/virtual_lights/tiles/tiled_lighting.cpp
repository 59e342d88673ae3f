#include "virtual_lights/tiles/tiled_lighting.h"

#include "virtual_lights/maps/imperfect_shadow_maps.h"
#include "virtual_lights/stopwatch.h"
#include "virtual_lights/tiles/pixel_lighting.h"
#include "virtual_lights/tiles/prepared_lights.h"
#include "virtual_lights/tiles/splatting.h"
#include "virtual_lights/tiles/tile_bounds.h"

#include <lightcull/error.h>

#include <ImathBox.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

namespace lightcull {
namespace {

/// The pixels of one tile of a sub-image: every `step`-th of every `step`-th row.
struct SubTile {
    std::uint32_t x0, y0, step, edge;  // edge: in pixels of the sub-image

    template <typename Visit>
    void for_each_pixel(const CameraView& view, Visit&& visit) const {
        for (std::uint32_t j = 0, y = y0; j < edge && y < view.height; ++j, y += step) {
            for (std::uint32_t i = 0, x = x0; i < edge && x < view.width; ++i, x += step) {
                const std::size_t pixel = view.index(x, y);
                if (view.hit[pixel] != 0) visit(pixel);
            }
        }
    }
};

std::vector<SubTile> sub_tiles(const CameraView& view, std::uint32_t step, std::uint32_t edge) {
    std::vector<SubTile> tiles;
    const std::uint32_t extent = edge * step;
    for (std::uint32_t y = 0; y < view.height; y += extent) {
        for (std::uint32_t x = 0; x < view.width; x += extent) {
            for (std::uint32_t i = 0; i < step * step; ++i) {
                tiles.push_back({x + i % step, y + i / step, step, edge});
            }
        }
    }
    return tiles;
}

/// Lights the pixels of a tile, each by the lights that are listed for its part of the tile.
LightingCounts light_tile(const PassLights& lights, const SubTile& tile, Span<V3f> pixels) {
    const CameraView& view = lights.pass.view;
    std::vector<V3f> points;
    tile.for_each_pixel(view, [&](std::size_t i) { points.push_back(view.view_positions[i]); });
    const TileBounds bounds{Span<const V3f>(points)};
    std::array<PreparedLights::List, TileBounds::kClusters> lists;
    const std::uint32_t subset = lights.subset_of(tile.x0, tile.y0);
    for (std::uint32_t c = 0; c < TileBounds::kClusters; ++c) {
        lists[c] = lights.lights.list(subset, bounds.piece(c));
    }
    PixelLighting lighting(lights, pixels);
    tile.for_each_pixel(view, [&](std::size_t i) {
        const PreparedLights::List& list = lists[bounds.cluster_of(view.view_positions[i])];
        lighting.count(i, list.size());
        lighting.add_all(i, list);
        lighting.finish(i);
    });
    return lighting.counts();
}

ImperfectShadowMaps make_maps(const LightingPass& pass, const PreparedLights& lights) {
    const std::vector<VirtualLight>& all = lights.all();
    if (all.size() > ImperfectShadowMaps::kMostLights) {
        throw Error("virtual lights: " + std::to_string(all.size()) +
                    " are too many for shadows=maps: at most " +
                    std::to_string(ImperfectShadowMaps::kMostLights));
    }
    std::vector<float> ranges(all.size(), std::numeric_limits<float>::infinity());
    if (pass.options.map_culling) {
        for (std::size_t i = 0; i < all.size(); ++i) {
            ranges[i] = std::sqrt(lights.listed(i).farthest2);
        }
    }
    return {all, ranges, *pass.cloud, pass.key};
}

}  // namespace

float nearest_distance2(const std::vector<VirtualLight>& lights) noexcept {
    Imath::Box3f box;
    for (const VirtualLight& light : lights) box.extendBy(light.position);
    if (box.isEmpty()) return 0.0f;
    const V3f size = box.size();
    return size.dot(size) / static_cast<float>(lights.size());
}

LightingCounts add_tiled_lighting(const LightingPass& pass, const std::vector<VirtualLight>& lights,
                                  const Acceptance& acceptance, Span<V3f> pixels) {
    const VirtualLightOptions& options = pass.options;
    const std::uint32_t subsets = options.interleave * options.interleave;
    const PreparedLights prepared(lights, acceptance, options.volume, pass.camera, subsets);
    LightingCounts sum;
    std::optional<ImperfectShadowMaps> maps;
    if (options.shadows == VirtualShadows::kMaps) {
        const Stopwatch watch;
        maps.emplace(make_maps(pass, prepared));
        sum.map_points = maps->splatted();
        sum.build_seconds = watch.seconds();
    }
    const PassLights of_pass{pass, prepared, acceptance, maps ? &*maps : nullptr,
                             nearest_distance2(lights)};
    if (options.culling == VirtualLightCulling::kSplatting) {
        sum += splat_lights(of_pass, pixels);
        return sum;
    }
    const std::vector<SubTile> tiles = sub_tiles(pass.view, options.interleave, options.tile);
    std::vector<LightingCounts> counts(tiles.size());
    tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
        if (!pass.cancelled()) counts[i] = light_tile(of_pass, tiles[i], pixels);
    });
    for (const LightingCounts& c : counts) sum += c;
    return sum;
}

}  // namespace lightcull
