#include "virtual_lights/maps/point_cloud.h"

#include "base/alias_table.h"
#include "base/parallel_blocks.h"
#include "render/facet.h"
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
        scene.for_each_placed(
            [&](MeshId mesh, std::uint32_t instance) { add(scene.triangles_of(mesh), instance); });
        std::vector<double> areas(places_.size());
        for (std::uint32_t k = 0; k < areas.size(); ++k) {
            const Facet facet = this->facet(k);
            areas[k] = 0.5 * Imath::V3d(facet.edge1.cross(facet.edge2)).length();
        }
        total_ = std::accumulate(areas.begin(), areas.end(), 0.0);
        if (total_ > 0.0) table_ = AliasTable(areas);
    }

    double area() const noexcept { return total_; }

    CloudPoint point(const PathRandom& random, float radius) const noexcept {
        const Facet f = facet(table_.sample(random.fine(Dimension::kSelectLight)));
        const V2f b = uniform_triangle(random.two(Dimension::kLightVertex));
        return {f.a + f.edge1 * b.x + f.edge2 * b.y, triangle_normal(f.edge1, f.edge2), radius};
    }

  private:
    struct Place {
        std::uint32_t triangle, instance;
    };

    void add(const SceneData::Range& triangles, std::uint32_t instance) {
        for (std::size_t t = triangles.begin; t < triangles.end; ++t) {
            places_.push_back({static_cast<std::uint32_t>(t), instance});
        }
    }
    Facet facet(std::uint32_t k) const noexcept {
        return {scene_, places_[k].triangle, places_[k].instance};
    }

    const SceneData& scene_;
    std::vector<Place> places_;
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
