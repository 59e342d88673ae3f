#include "virtual_lights/maps/point_cloud.h"

#include "base/alias_table.h"
#include "base/parallel_blocks.h"
#include "render/morton_sort.h"
#include "render/path_random.h"
#include "render/warp.h"

#include <cmath>
#include <numeric>

namespace lightcull {
namespace {

/// Draws points from all triangles by area.
class Surfaces {
  public:
    explicit Surfaces(const SceneData& scene) : scene_(scene) {
        std::vector<double> areas(scene.triangles.size());
        for (std::uint32_t t = 0; t < areas.size(); ++t) {
            const V3f edge1 = corner(t, 1) - corner(t, 0), edge2 = corner(t, 2) - corner(t, 0);
            areas[t] = 0.5 * Imath::V3d(edge1.cross(edge2)).length();
        }
        total_ = std::accumulate(areas.begin(), areas.end(), 0.0);
        if (total_ > 0.0) table_ = AliasTable(areas);
    }

    double area() const noexcept { return total_; }

    CloudPoint point(const PathRandom& random, float radius) const noexcept {
        const std::uint32_t t = table_.sample(random.fine(Dimension::kSelectLight));
        const V2f b = uniform_triangle(random.two(Dimension::kLightVertex));
        const V3f &a = corner(t, 0), edge1 = corner(t, 1) - a, edge2 = corner(t, 2) - a;
        return {a + edge1 * b.x + edge2 * b.y, triangle_normal(edge1, edge2), radius};
    }

  private:
    const V3f& corner(std::uint32_t triangle, std::uint32_t k) const noexcept {
        return scene_.positions[scene_.corner(triangle, k)];
    }

    const SceneData& scene_;
    double total_ = 0.0;
    AliasTable table_;
};

std::vector<CloudPoint> along_curve(const std::vector<CloudPoint>& points) {
    std::vector<V3f> positions;
    positions.reserve(points.size());
    for (const CloudPoint& point : points) positions.push_back(point.position);
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::vector<std::uint64_t> keys;
    sort_by_morton_code(positions, order, keys);
    std::vector<CloudPoint> sorted;
    sorted.reserve(points.size());
    for (const std::uint32_t i : order) sorted.push_back(points[i]);
    return sorted;
}

BoxTree tree_of(const std::vector<CloudPoint>& points) {
    std::vector<AlignedBox> boxes;
    boxes.reserve(points.size());
    for (const CloudPoint& point : points) boxes.push_back({point.position, point.position});
    return BoxTree(boxes);
}

}  // namespace

PointCloud::PointCloud(const SceneData& scene, std::uint32_t parts, std::uint32_t per_part,
                       std::uint64_t key) {
    const Surfaces surfaces(scene);
    if (!(surfaces.area() > 0.0)) return;
    const auto radius =
        static_cast<float>(std::sqrt(surfaces.area() / (static_cast<double>(kPi) * per_part)));
    parts_.resize(parts);
    for_each_block(parts, 1, [&](std::size_t p, std::size_t) {
        std::vector<CloudPoint> points;
        points.reserve(per_part);
        for (std::uint32_t i = 0; i < per_part; ++i) {
            const auto number = static_cast<std::uint32_t>(p) * per_part + i;
            points.push_back(surfaces.point({key, number, 0}, radius));
        }
        parts_[p].points = along_curve(points);
        parts_[p].tree = tree_of(parts_[p].points);
    });
}

}  // namespace lightcull
