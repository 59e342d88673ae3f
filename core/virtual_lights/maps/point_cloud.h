#pragma once

#include "base/memory_size.h"
#include "render/scene_data.h"
#include "render/vec.h"
#include "virtual_lights/volumes/box_tree.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightcull {

/// A piece of a surface that casts shadows into imperfect shadow maps.
struct CloudPoint {
    V3f position;
    V3f normal;  ///< normal on the side where the triangle's corners run anticlockwise, unit length
    float radius;  ///< radius of a disk of the area that the point stands for if all of a part are
                   ///< used
};

/// Points spread over all triangles of a scene evenly by area, in parts of which each is spread
/// evenly by itself.
class PointCloud {
  public:
    /// Makes a cloud without points.
    PointCloud() = default;
    /// Makes `parts` parts of `per_part` points, both above 0; none without triangles. key: key of
    /// the random numbers. Runs in the caller's TBB arena.
    PointCloud(const SceneData& scene, std::uint32_t parts, std::uint32_t per_part,
               std::uint64_t key);

    std::size_t part_count() const noexcept { return parts_.size(); }
    const std::vector<CloudPoint>& part(std::size_t i) const noexcept { return parts_[i].points; }

    /// Calls visit(point) for the points of a part that lie in the cube about a place whose edge is
    /// twice `reach`, which may be infinite.
    template <typename Visit>
    void for_near(std::size_t part, const V3f& place, float reach, Visit&& visit) const {
        constexpr float kFarthest = 1e30f;  // farther than any place of a scene
        const V3f half(std::min(reach, kFarthest));
        const AlignedBox cube{place - half, place + half};
        parts_[part].tree.for_overlapping(cube,
                                          [&](std::uint32_t i) { visit(parts_[part].points[i]); });
    }

    /// The memory that the cloud takes, bytes.
    std::size_t memory_size() const noexcept {
        std::size_t sum = 0;
        for (const Part& part : parts_) sum += size_of(part.points) + part.tree.memory_size();
        return sum;
    }

  private:
    struct Part {
        std::vector<CloudPoint> points;  // points along a Morton curve
        BoxTree tree;
    };

    std::vector<Part> parts_;
};

}  // namespace lightcull
