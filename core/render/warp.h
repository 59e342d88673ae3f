#pragma once

#include "render/trigonometry.h"
#include "render/vec.h"

#include <algorithm>
#include <cmath>

/// Maps from the unit square.

namespace lightcull {

/// A point uniform over the unit disk: Shirley and Chiu's concentric map.
inline V2f uniform_disk(const V2f& u) noexcept {
    const float x = 2.0f * u.x - 1.0f, y = 2.0f * u.y - 1.0f;
    if (x == 0.0f && y == 0.0f) return {0.0f, 0.0f};
    const bool wide = std::fabs(x) > std::fabs(y);
    const float radius = wide ? x : y, rest = wide ? y : x;
    const auto [sine, cosine] = sine_cosine(0.25f * kPi * (rest / radius));
    return wide ? V2f(radius * cosine, radius * sine) : V2f(radius * sine, radius * cosine);
}

/// A direction cosine-weighted over the hemisphere about +Z.
inline V3f cosine_hemisphere(const V2f& u) noexcept {
    const V2f d = uniform_disk(u);
    return {d.x, d.y, std::sqrt(std::max(0.0f, 1.0f - d.x * d.x - d.y * d.y))};
}

/// A point uniform over a triangle: barycentric coordinates of its second and third corner.
inline V2f uniform_triangle(const V2f& u) noexcept {
    const float root = std::sqrt(u.x);
    return {root * (1.0f - u.y), root * u.y};
}

}  // namespace lightcull
