#include "virtual_lights/point_cloud.h"

#include "base/alias_table.h"
#include "lights/parallel_blocks.h"
#include "render/path_random.h"
#include "render/warp.h"

#include <cmath>

namespace lightcull {

std::vector<CloudPoint> make_point_cloud(const Scene::Impl& scene, std::uint32_t count,
                                         std::uint32_t per_map, std::uint64_t key) {
    std::vector<double> areas(scene.triangles.size());
    double total = 0.0;
    const auto corner = [&](std::uint32_t triangle, std::uint32_t k) -> const V3f& {
        return scene.positions[scene.corner(triangle, k)];
    };
    for (std::uint32_t t = 0; t < areas.size(); ++t) {
        const V3f edge1 = corner(t, 1) - corner(t, 0), edge2 = corner(t, 2) - corner(t, 0);
        areas[t] = 0.5 * static_cast<double>(edge1.cross(edge2).length());
        total += areas[t];
    }
    if (!(total > 0.0)) return {};
    const AliasTable table(areas);
    const auto radius = static_cast<float>(std::sqrt(total / (static_cast<double>(kPi) * per_map)));
    std::vector<CloudPoint> points(count);
    constexpr std::size_t kBlock = 4096;
    for_each_block(count, kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const PathRandom random(key, static_cast<std::uint32_t>(i), 0);
            const std::uint32_t t = table.sample(random.fine(Dimension::kSelectLight));
            const V2f b = uniform_triangle(random.two(Dimension::kLightVertex));
            const V3f &a = corner(t, 0), edge1 = corner(t, 1) - a, edge2 = corner(t, 2) - a;
            points[i] = {a + edge1 * b.x + edge2 * b.y, unit(edge1.cross(edge2)), radius};
        }
    });
    return points;
}

}  // namespace lightcull
