#pragma once

#include <lightcull/float3.h>

#include <algorithm>
#include <cmath>

/// Arithmetic on the public float3, for core/lights, which is to depend on nothing.

namespace lightcull {

constexpr float3 operator+(float3 a, float3 b) noexcept {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr float3 operator-(float3 a, float3 b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr float3 operator-(float3 a) noexcept {
    return {-a.x, -a.y, -a.z};
}
constexpr float3 operator*(float3 a, float s) noexcept {
    return {a.x * s, a.y * s, a.z * s};
}

constexpr float dot(float3 a, float3 b) noexcept {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr float3 cross(float3 a, float3 b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(float3 a) noexcept {
    return std::sqrt(dot(a, a));
}

inline float3 min(float3 a, float3 b) noexcept {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline float3 max(float3 a, float3 b) noexcept {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

inline bool is_finite(float3 a) noexcept {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace lightcull
