#pragma once

#include <lightcull/span.h>

#include <algorithm>

#include "base/float3_math.h"

namespace lightcull {

/// A pair of spheres of one centre: about the volumes in which lights are accepted, and about the
/// lights alone.
struct EnclosingSphere {
    float3 center{0, 0, 0};
    float radius = 0.0f;
    float bounds = 0.0f;  ///< radius of the sphere about the lights
};

/// A factor that makes a radius hold what a sum and a distance, which are rounded, say that it
/// holds.
inline constexpr float kSphereRoundUp = 1.0f + 1e-6f;

/// The sphere that encloses spheres, of which there is one at least, about the middle of the box
/// around them. `bounds` is rounded up; the radius grows by `radius_margin`, 1 where it need not
/// hold all to the last digit.
inline EnclosingSphere enclose(Span<const EnclosingSphere> spheres, float radius_margin) noexcept {
    constexpr float3 kAll{1e30f, 1e30f, 1e30f};
    float3 low = kAll, high = kAll * -1.0f;
    for (const EnclosingSphere& sphere : spheres) {
        const float3 r{sphere.radius, sphere.radius, sphere.radius};
        // The range of a sun may be infinite.
        low = min(low, max(sphere.center - r, kAll * -1.0f));
        high = max(high, min(sphere.center + r, kAll));
    }
    EnclosingSphere result{low * 0.5f + high * 0.5f, 0.0f, 0.0f};
    for (const EnclosingSphere& sphere : spheres) {
        const float away = length(sphere.center - result.center);
        result.radius = std::max(result.radius, (sphere.radius + away) * radius_margin);
        result.bounds = std::max(result.bounds, (sphere.bounds + away) * kSphereRoundUp);
    }
    return result;
}

}  // namespace lightcull
