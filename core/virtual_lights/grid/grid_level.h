#pragma once

#include "render/vec.h"
#include "virtual_lights/light/virtual_light.h"

#include <ImathVec.h>
#include <cstdint>
#include <vector>

namespace lightcull {

/// Sums over lights, from which the light that stands for them is made. They are in double, as they
/// are sums of many.
struct LightMoments {
    Imath::V3d strength{0.0};  ///< strength of a Lambertian light along its normal, W/sr
    double weight = 0.0;       ///< luminance of the strength, by which the following are weighted
    Imath::V3d position{0.0}, square{0.0};  ///< position, by component, and its square
    Imath::V3d normal{0.0};

    void add(const LightMoments& other, double share) noexcept;
};

/// The moments of one virtual light; a glossy one counts as a diffuse one that reflects as much.
LightMoments moments_of(const VirtualLight& light) noexcept;

/// A light that stands for the lights around a vertex of a grid ([LY19] sections 2.2 and 3.3).
struct GridLight {
    V3f position;   ///< illumination centre
    V3f deviation;  ///< standard deviation of the lights' positions about it
    V3f strength;   ///< sum of the lights' strengths, W/sr
    V3f normal;     ///< mean of the lights' normals, shorter the more they differ
};
GridLight light_of(const LightMoments& moments) noexcept;

/// The radiant intensity into a direction (unit length): that of Lambertian lights whose normals
/// spread about their mean as much as its length says; it is exact where they are equal, and where
/// they point anywhere alike.
V3f intensity(const GridLight& light, const V3f& outgoing) noexcept;

/// Cells of edge `edge` from `origin` on, less than 1024 a side.
struct GridCells {
    V3f origin;
    float edge;
};

/// Deals every light out among the 8 vertices of its cell by trilinear weights, and returns the
/// vertices that got something, along a Morton curve. Runs in the caller's TBB arena; the result
/// does not depend on it.
std::vector<LightMoments> scatter_to_vertices(const std::vector<LightMoments>& lights,
                                              const GridCells& cells);

}  // namespace lightcull
