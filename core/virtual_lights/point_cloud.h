#pragma once

#include "render/scene_impl.h"
#include "render/vec.h"

#include <cstdint>
#include <vector>

namespace lightcull {

/// A piece of a surface that casts shadows into imperfect shadow maps.
struct CloudPoint {
    V3f position;
    V3f normal;    ///< unit length, on the side where the triangle's corners run anticlockwise
    float radius;  ///< of a disk of the area that the point stands for if all of a map's are used
};

/// `count` points spread over all triangles evenly by area, in random order: any run of them is
/// spread evenly. per_map: how many a map uses, for the radius. Empty without triangles. key: of
/// the random numbers.
std::vector<CloudPoint> make_point_cloud(const Scene::Impl& scene, std::uint32_t count,
                                         std::uint32_t per_map, std::uint64_t key);

}  // namespace lightcull
