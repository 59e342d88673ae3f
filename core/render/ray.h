#pragma once

#include "render/vec.h"

#include <cstdint>
#include <limits>

namespace lightcull {

struct Ray {
    V3f origin;
    V3f direction;
    float end = std::numeric_limits<float>::infinity();  ///< in lengths of `direction`
};

/// How far to move a point that was interpolated in a triangle along the triangle's unit normal,
/// so that a ray from there does not hit the triangle again. It bounds the rounding error of the
/// point, which grows with the coordinates, and that of the intersection, which grows with the
/// edges. magnitude: the corners' largest coordinates, absolute.
inline float clearance(const V3f& normal, const V3f& magnitude, const V3f& edge1,
                       const V3f& edge2) noexcept {
    constexpr float kRounding = 16.0f * 0x1p-24f;
    const float edge = std::fmax(max_component(abs(edge1)), max_component(abs(edge2)));
    return kRounding * (abs(normal).dot(magnitude) + edge);
}

/// Where a shadow ray ends, in parts of the way to the light, so that rounding does not let it hit
/// the light itself.
inline constexpr float kShadowEnd = 1.0f - 0x1p-16f;

inline constexpr std::uint32_t kNoHit = 0xffffffffu;

struct Hit {
    std::uint32_t triangle;  ///< index over all meshes, or kNoHit
    float u, v;              ///< barycentric coordinates of the second and third corner
};

}  // namespace lightcull
