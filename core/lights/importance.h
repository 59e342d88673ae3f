#pragma once

#include <algorithm>
#include <cmath>

#include "base/float3_math.h"
#include "lights/light_record.h"

namespace lightcull {

/// The way from a point to the centre of a light's bounding sphere.
struct Approach {
    float distance2;
    float distance;
    float3 direction;  ///< unit length; arbitrary at distance 0
};

inline Approach approach(float3 from, float3 center) noexcept {
    const float3 way = center - from;
    const float distance2 = dot(way, way);
    const float distance = std::sqrt(distance2);
    // Not 1 / distance2: the square of a small distance may vanish.
    const float inverse = distance > 0.0f ? 1.0f / distance : 0.0f;
    return {distance2, distance, way * inverse};
}

/// An angle in [0, pi] by its sine and cosine.
struct Angle {
    float sine, cosine;

    static Angle from_cosine(float c) noexcept {
        return {std::sqrt(std::max(0.0f, 1.0f - c * c)), c};
    }
    static Angle from_sine_acute(float s) noexcept {
        return {s, std::sqrt(std::max(0.0f, 1.0f - s * s))};
    }
};

/// max(0, a - b).
inline Angle subtract_clamped(Angle a, Angle b) noexcept {
    if (a.cosine >= b.cosine) return {0.0f, 1.0f};
    return {a.sine * b.cosine - a.cosine * b.sine, a.cosine * b.cosine + a.sine * b.sine};
}

/// The largest cosine with which anything in a cone of normals (axis, theta_o) may emit into a
/// direction at cos_theta from the axis, from anywhere in a sphere that fills `half_view`; 0 where
/// nothing can.
inline float emitter_cosine(float cos_theta, Angle theta_o, float cos_theta_e,
                            Angle half_view) noexcept {
    const Angle from_normal = subtract_clamped(Angle::from_cosine(cos_theta), theta_o);
    const float cosine = subtract_clamped(from_normal, half_view).cosine;
    return cosine > cos_theta_e ? cosine : 0.0f;
}

/// The largest cosine under which a receiver sees anything of that sphere; 1 for a zero normal.
inline float receiver_cosine(float3 normal, float3 direction, Angle half_view) noexcept {
    if (normal.x == 0.0f && normal.y == 0.0f && normal.z == 0.0f) return 1.0f;
    const float cosine = std::clamp(dot(normal, direction), -1.0f, 1.0f);
    return std::max(0.0f, subtract_clamped(Angle::from_cosine(cosine), half_view).cosine);
}

/// Keeps 1 / d^2 finite for a point on a light without extent.
inline constexpr float kMinDistance2 = 1e-30f;

/// g_i(x) of [TH16] Eq. 9, with both cosines widened by the angle that the light's bounding sphere
/// fills, so that it is 0 only where the light cannot reach x.
inline float importance(const LightRecord& light, const Approach& way, float3 normal) noexcept {
    const float radius2 = light.radius * light.radius;
    const float fall_off = light.intensity / std::max({way.distance2, radius2, kMinDistance2});
    if (way.distance <= light.radius) return fall_off;  // x sees the sphere in every direction

    const Angle half_view = Angle::from_sine_acute(light.radius / way.distance);
    const float receiver = receiver_cosine(normal, way.direction, half_view);
    const float3 axis = float3{static_cast<float>(light.axis[0]), static_cast<float>(light.axis[1]),
                               static_cast<float>(light.axis[2])} *
                        LightRecord::kSnorm;
    float cos_theta = std::clamp(-dot(axis, way.direction), -1.0f, 1.0f);
    if (light.two_sided != 0) cos_theta = std::abs(cos_theta);
    const Angle theta_o =
        Angle::from_cosine(static_cast<float>(light.cos_theta_o) * LightRecord::kSnorm);
    const float cos_theta_e = static_cast<float>(light.cos_theta_e) * LightRecord::kSnorm;
    return fall_off * receiver * emitter_cosine(cos_theta, theta_o, cos_theta_e, half_view);
}

}  // namespace lightcull
