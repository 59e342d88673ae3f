#pragma once

#include <algorithm>
#include <cmath>

#include "base/float3_math.h"
#include "lights/light_record.h"

namespace lightcull {

/// The way from a point to the centre of a light's bounding sphere.
struct Approach {
    float3 way;
    float distance2;
    float distance;

    /// Unit length, or 0 at distance 0.
    float3 direction() const noexcept { return way * (distance > 0.0f ? 1.0f / distance : 0.0f); }
};

inline Approach approach(float3 from, float3 center) noexcept {
    const float3 way = center - from;
    const float distance2 = dot(way, way);
    return {way, distance2, std::sqrt(distance2)};
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

/// The axis of a light, of about unit length.
inline float3 axis_of(const LightRecord& light) noexcept {
    return float3{static_cast<float>(light.axis[0]), static_cast<float>(light.axis[1]),
                  static_cast<float>(light.axis[2])} *
           LightRecord::kSnorm;
}

/// The angle that a light's bounding sphere fills, half of it; the point is outside.
inline Angle half_view_of(const LightRecord& light, const Approach& way) noexcept {
    return Angle::from_sine_acute(light.radius / way.distance);
}

inline float emitter_bound(const LightRecord& light, const Approach& way,
                           Angle half_view) noexcept {
    float cos_theta = std::clamp(-dot(axis_of(light), way.direction()), -1.0f, 1.0f);
    if (light.two_sided != 0) cos_theta = std::abs(cos_theta);
    const Angle theta_o =
        Angle::from_cosine(static_cast<float>(light.cos_theta_o) * LightRecord::kSnorm);
    return emitter_cosine(cos_theta, theta_o,
                          static_cast<float>(light.cos_theta_e) * LightRecord::kSnorm, half_view);
}

/// g_i(x) of [TH16] Eq. 9: intensity by the squared distance of the centre and by both cosines. The
/// paper takes the largest cosine of three corners for the receiver; a bounding sphere has none, so
/// both cosines are the largest that anything in the sphere can have. Tests hold samplers to it.
inline float importance_bound(const LightRecord& light, const Approach& way,
                              float3 normal) noexcept {
    const float radius2 = light.radius * light.radius;
    const float fall_off = light.intensity / std::max({way.distance2, radius2, kMinDistance2});
    if (way.distance <= light.radius) return fall_off;  // x sees the sphere in every direction
    const Angle half_view = half_view_of(light, way);
    return fall_off * receiver_cosine(normal, way.direction(), half_view) *
           emitter_bound(light, way, half_view);
}

/// The mean over a light of max(0, c), where c is a height above some plane: `height` at the
/// light's centre, of a variance of `variance`.
inline float mean_above(float height, float variance) noexcept {
    return 0.5f * (height + std::sqrt(height * height + variance));
}

/// Of triangles of common shapes, the mean squared distance from the centre of the bounding sphere
/// is this times the square of its radius.
inline constexpr float kSpread = 0.25f;
/// The variance of a height over a light, by its spread.
inline constexpr float kHeightSpread = 0.375f;
/// What rounding the axis to 16 bits may add to a cosine.
inline constexpr float kAxisRounding = 5e-5f;

/// An estimate of g_i(x), what the light gives a point but for visibility and BSDF: intensity by
/// the mean squared distance, by the mean cosines at emitter and receiver. 0 only where the light
/// cannot reach x. Bounds, as in importance_bound(), favour near lights wherever they face.
inline float importance(const LightRecord& light, const Approach& way, float3 normal) noexcept {
    const float spread = kSpread * light.radius * light.radius;
    const float mean_distance2 = std::max(way.distance2 + spread, kMinDistance2);
    const float inverse = 1.0f / std::sqrt(mean_distance2);

    float receiver = 1.0f;
    if (normal.x != 0.0f || normal.y != 0.0f || normal.z != 0.0f) {
        const float height = dot(normal, way.way);
        if (height + light.radius <= 0.0f) return 0.0f;
        receiver = mean_above(height, kHeightSpread * spread) * inverse;
    }

    float emitter = 1.0f;
    if (light.cos_theta_o == LightRecord::kFlat) {
        // One height above the plane of the light holds for all of it.
        float height = -dot(axis_of(light), way.way);
        if (light.two_sided != 0) height = std::abs(height);
        emitter = std::min(height * inverse + kAxisRounding, 1.0f);
    } else if (way.distance > light.radius) {
        emitter = emitter_bound(light, way, half_view_of(light, way));
    }
    if (!(emitter > 0.0f)) return 0.0f;
    return light.intensity * inverse * inverse * receiver * emitter;
}

}  // namespace lightcull
