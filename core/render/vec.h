#pragma once

#include <lightcull/float3.h>

#include <ImathVec.h>
#include <algorithm>
#include <cmath>

/// Vectors inside core/render are Imath's; float3 is for the public headers alone.

namespace lightcull {

using Imath::V2f;
using Imath::V3d;
using Imath::V3f;

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kInvPi = 0.31830988618379067154f;

inline V3f to_v3f(float3 a) noexcept {
    return {a.x, a.y, a.z};
}
inline float3 to_float3(const V3f& a) noexcept {
    return {a.x, a.y, a.z};
}

inline bool is_finite(const V3f& a) noexcept {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
inline float max_component(const V3f& a) noexcept {
    return std::max(a.x, std::max(a.y, a.z));
}
template <typename T>
Imath::Vec3<T> abs(const Imath::Vec3<T>& a) noexcept {
    return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)};
}

/// The unit vector along a, which must not be 0. Imath's own asks about denormal lengths first.
inline V3f unit(const V3f& a) noexcept {
    return a * (1.0f / std::sqrt(a.dot(a)));
}

/// The unit vector along a of any length that floats can have; 0 for 0.
inline V3f direction(float3 a) noexcept {
    return V3f(V3d(a.x, a.y, a.z).normalized());
}

/// Luminance of linear RGB with the sRGB primaries (Rec. 709).
inline float luminance(const V3f& rgb) noexcept {
    return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z;
}

/// The unit normal of a triangle by two of its edges, 0 if it has no area. The fourth power of an
/// edge, which floats do not hold of each, is formed only where they do.
inline V3f triangle_normal(const V3f& edge1, const V3f& edge2) noexcept {
    constexpr float kLeast = 1e-30f, kMost = 1e38f;
    const V3f across = edge1.cross(edge2);
    const float squared = across.dot(across);
    if (squared > kLeast && squared < kMost) return across * (1.0f / std::sqrt(squared));
    return V3f(Imath::V3d(across).normalized());
}

/// An orthonormal basis around a unit normal (Duff et al. 2017, "Building an Orthonormal Basis,
/// Revisited").
class Basis {
  public:
    Basis() = default;
    explicit Basis(const V3f& n) noexcept : normal(n) {
        const float sign = std::copysign(1.0f, n.z);
        const float a = -1.0f / (sign + n.z);
        const float b = n.x * n.y * a;
        tangent = V3f(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
        bitangent = V3f(b, sign + n.y * n.y * a, -n.y);
    }

    V3f to_local(const V3f& v) const noexcept {
        return {v.dot(tangent), v.dot(bitangent), v.dot(normal)};
    }
    V3f to_world(const V3f& v) const noexcept {
        return tangent * v.x + bitangent * v.y + normal * v.z;
    }

    V3f tangent, bitangent, normal;
};

}  // namespace lightcull
