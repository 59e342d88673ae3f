#include "base/random.h"
#include "render/camera.h"
#include "render/scene_data.h"
#include "render/settings.h"
#include "render/tiles.h"
#include "render/wavefront.h"

#include <lightcull/error.h>
#include <lightcull/render/renderer.h>

#include <tbb/parallel_for.h>

namespace lightcull {
namespace {

using Points = std::vector<ShadingPoint>;

/// The tiles of the image, in the order of the regions that they make up.
std::vector<Tile> tiles_by_region(const RenderSettings& settings) {
    std::vector<Tile> tiles;
    for (const Tile& region : tiles_of({0, 0, settings.width, settings.height}, kRegionSize)) {
        const std::vector<Tile> inside = tiles_of(region, kTileSize);
        tiles.insert(tiles.end(), inside.begin(), inside.end());
    }
    return tiles;
}

/// The vertices of the paths of a tile after `depth` edges.
Points points_of_tile(const Pass& pass, const Tile& tile, std::uint32_t depth) {
    Wavefront wavefront;
    wavefront.start(pass, tile);
    for (std::uint32_t edges = 1; wavefront.advance(); ++edges) {
        const Span<const ShadingPoint> points = wavefront.points();
        if (edges == depth) return {points.begin(), points.end()};
        wavefront.shade();
    }
    return {};
}

}  // namespace

std::vector<ShadingPoint> path_points(const Scene& scene, const RenderSettings& settings,
                                      const LightSampler& sampler, std::uint32_t depth) {
    check_committed(scene);
    check_settings(settings);
    if (depth < 1 || depth > 65535) throw Error("path_points: depth is not in [1, 65535]");
    RenderSettings walk = settings;
    walk.max_depth = depth + 1;
    // Light that paths find by themselves would be asked of the sampler, whose pass has not begun.
    walk.direct_light = DirectLight::kLights;
    const CameraRays camera(scene.camera(), walk.width, walk.height);
    std::vector<V3f> pixels(std::size_t{walk.width} * walk.height);
    constexpr std::uint64_t kFirstPass = 0;
    const Pass pass{data_of(scene),
                    walk,
                    PassRays(camera, walk, kFirstPass),
                    sampler,
                    nullptr,
                    kFirstPass,
                    hash(walk.seed, kFirstPass),
                    numbers_key(walk, kFirstPass),
                    nullptr,
                    pixels.data(),
                    nullptr};

    const std::vector<Tile> tiles = tiles_by_region(walk);
    std::vector<Points> parts(tiles.size());
    tbb::parallel_for(std::size_t{0}, tiles.size(),
                      [&](std::size_t i) { parts[i] = points_of_tile(pass, tiles[i], depth); });
    Points all;
    for (const Points& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace lightcull
