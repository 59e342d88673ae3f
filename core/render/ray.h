#pragma once

#include "render/vec.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace lightcull {

inline constexpr std::uint32_t kNoHit = 0xffffffffu;
inline constexpr std::uint32_t kNotInstanced = 0xffffffffu;

struct Ray {
    V3f origin;
    V3f direction;
    /// The end of the ray, in lengths of `direction`.
    float end = std::numeric_limits<float>::infinity();
    std::uint32_t end_triangle = kNoHit;  ///< the triangle on which a shadow ray ends, if any
};

/// The distance by which a point that was interpolated in a triangle moves along the triangle's
/// unit normal, so that a ray from there does not hit the triangle again. It bounds the rounding
/// error of the point, which grows with the coordinates, and that of the intersection, which grows
/// with the edges. magnitude: the corners' largest coordinates, absolute.
inline float clearance(const V3f& normal, const V3f& magnitude, const V3f& edge1,
                       const V3f& edge2) noexcept {
    constexpr float kRounding = 16.0f * 0x1p-24f;
    const float edge = std::max(max_component(abs(edge1)), max_component(abs(edge2)));
    return kRounding * (abs(normal).dot(magnitude) + edge);
}

/// A shadow ray from one place to another, which may lie on a triangle.
inline Ray segment(const V3f& from, const V3f& to, std::uint32_t end_triangle = kNoHit) noexcept {
    return {from, to - from, 1.0f, end_triangle};
}

struct Hit {
    std::uint32_t triangle;  ///< index of the triangle over all meshes, or kNoHit
    float u, v;              ///< barycentric coordinates of the second and third corner
    std::uint32_t instance = kNotInstanced;  ///< the instance whose triangle it is
};

}  // namespace lightcull
