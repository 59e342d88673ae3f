#pragma once

#include "render/surface.h"

#include <algorithm>
#include <cmath>

namespace lightcull {

/// The degree to which the surfaces that two pixels show are one, [0, 1]: by their normals, and by
/// how far the other lies off the plane of this one, a hundredth of whose distance from the camera
/// (`depth`) is much.
inline float likeness(const Surface& surface, const Surface& other, float depth) noexcept {
    constexpr float kPlaneWidth = 0.01f;
    const float cosine = std::max(0.0f, surface.bsdf.normal().dot(other.bsdf.normal()));
    const float c4 = cosine * cosine * cosine * cosine;
    const float off_plane =
        surface.normal.dot(other.position - surface.position) / (kPlaneWidth * depth);
    return c4 * c4 * std::exp(-0.5f * off_plane * off_plane);
}

}  // namespace lightcull
