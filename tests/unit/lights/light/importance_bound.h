#pragma once

#include "lights/light/importance.h"

namespace lightcull::testing {

/// The largest cosine under which a receiver sees anything of a sphere that fills `half_view`; 1
/// for a zero normal.
inline float receiver_cosine(float3 normal, const Approach& way, Angle half_view) noexcept {
    if (normal.x == 0.0f && normal.y == 0.0f && normal.z == 0.0f) return 1.0f;
    const Angle angle{length(cross(normal, way.way)) / way.distance,
                      dot(normal, way.way) / way.distance};
    return std::max(0.0f, subtract_clamped(angle, half_view).cosine);
}

/// A bound on g_i(x) of [TH16] Eq. 9: intensity by the squared distance of the centre and by both
/// cosines. The paper takes the largest cosine of three corners for the receiver; a bounding sphere
/// has none, so both cosines are the largest that anything in the sphere can have.
inline float importance_bound(const LightRecord& light, const Approach& way,
                              float3 normal) noexcept {
    const float radius2 = light.radius * light.radius;
    const float fall_off = light.intensity / std::max({way.distance2, radius2, kMinDistance2});
    if (way.distance <= light.radius) return fall_off;  // x sees the sphere in every direction
    const Angle half_view = Angle::from_sine_acute(light.radius / way.distance);
    return fall_off * receiver_cosine(normal, way, half_view) *
           std::max(0.0f, emitter_bound(light, way));
}

}  // namespace lightcull::testing
