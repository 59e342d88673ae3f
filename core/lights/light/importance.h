#pragma once

#include <algorithm>
#include <cmath>

#include "base/float3_math.h"
#include "lights/light/light_record.h"
#include "lights/light/receiver.h"

namespace lightcull {

/// The way from a point to the centre of a light's bounding sphere.
struct Approach {
    float3 way;
    float distance2;
    float distance;
};

inline Approach approach(float3 from, float3 center) noexcept {
    const float3 way = center - from;
    const float distance2 = dot(way, way);
    return {way, distance2, std::sqrt(distance2)};
}

/// An angle in [0, pi] by its sine and cosine, both of them times a number above 0.
struct Angle {
    float sine, cosine;

    static Angle from_sine_acute(float s) noexcept {
        return {s, std::sqrt(std::max(0.0f, 1.0f - s * s))};
    }
    static Angle from_half_sine(float s) noexcept {
        const float twice = s + s;
        return {twice * std::sqrt(1.0f - s * s), 1.0f - twice * s};
    }
};

/// The angle max(0, a - b), where b is neither 0 nor pi. It is the sign of the sine that decides:
/// the cosines of small angles do not differ.
inline Angle subtract_clamped(Angle a, Angle b) noexcept {
    const float sine = a.sine * b.cosine - a.cosine * b.sine;
    if (!(sine > 0.0f)) return {0.0f, 1.0f};
    return {sine, a.cosine * b.cosine + a.sine * b.sine};
}

/// The least mean squared distance. A point on a light without extent is closer: the light gives it
/// nothing that is defined, and 1 / d^2 would outweigh all that others give.
inline constexpr float kMinDistance = 1e-15f, kMinDistance2 = kMinDistance * kMinDistance;

/// The most that rounding the axis to 16 bits may add to a cosine, an angle or its length.
inline constexpr float kAxisRounding = 5e-5f;

/// The axis of a light in parts of LightRecord::kSnorm.
inline float3 snorm_axis_of(const LightRecord& light) noexcept {
    return {static_cast<float>(light.axis[0]), static_cast<float>(light.axis[1]),
            static_cast<float>(light.axis[2])};
}
/// The axis of a light, of about unit length.
inline float3 axis_of(const LightRecord& light) noexcept {
    return snorm_axis_of(light) * LightRecord::kSnorm;
}

/// The root of what the intensity of a glossy lobe towards the point falls by: the distance over
/// that of [TH17] Eq. 12. The lobe lies about `axis` (unit length); its sharpness is that of
/// lobe_sharpness().
inline float lobe_fall_off(float3 axis, float sharpness, const Approach& way) noexcept {
    const float along = -dot(axis, way.way);
    // The square of the sine of half the angle; (1 - cosine) / 2 would cancel near the axis.
    float half_sine2 = 0.5f * (1.0f - along / way.distance);
    if (along > 0.0f) {
        const float3 across = cross(axis, way.way);
        half_sine2 = 0.5f * dot(across, across) / (way.distance * (way.distance + along));
    }
    return 1.0f + sharpness * half_sine2;
}

/// The sharpness 1 / alpha^2 - 1 of a glossy point.
inline float lobe_sharpness(const LightRecord& light) noexcept {
    return 1.0f / (light.alpha() * light.alpha()) - 1.0f;
}

/// The largest cosine with which anything in the light's cone of normals, which are not all, may
/// emit towards the point, from anywhere in its bounding sphere, outside of which the point lies;
/// not above 0 where nothing can. The cross product keeps the digits of small angles.
inline float emitter_bound(const LightRecord& light, const Approach& way) noexcept {
    const float inverse = 1.0f / way.distance;
    const float3 axis = axis_of(light), across = cross(axis, way.way);
    float cosine = -dot(axis, way.way) * inverse;
    if (light.two_sided != 0) cosine = std::abs(cosine);
    const float half_sine = static_cast<float>(light.half_sine_o) * LightRecord::kSnorm;
    Angle from_normal = subtract_clamped({std::sqrt(dot(across, across)) * inverse, cosine},
                                         Angle::from_half_sine(half_sine));
    if (light.radius > 0.0f) {
        from_normal = subtract_clamped(from_normal, Angle::from_sine_acute(light.radius * inverse));
    }
    // This is kSnorm, and 5e-5 more of it for the length of the axis.
    constexpr float kLargest = 3.05201e-5f;
    const bool is_within = from_normal.sine <= static_cast<float>(light.sin_theta_e) * kLargest;
    return is_within ? from_normal.cosine : 0.0f;
}

/// The mean over a light of max(0, c), where c is a height above some plane: `height` at the
/// light's centre, with a variance of `variance`.
inline float mean_above(float height, float variance) noexcept {
    return 0.5f * (height + std::sqrt(height * height + variance));
}

/// The mean squared distance from the centre of the bounding sphere, over the square of its radius,
/// for triangles of common shapes.
inline constexpr float kSpread = 0.25f;
/// The variance of a height over a light, by its spread.
inline constexpr float kHeightSpread = 0.375f;

/// The least square of a sum of two directions.
inline constexpr float kLeastTwiceHalf2 = 1e-20f;

/// The mean over a light of a receiver's GlossyLobe, towards `direction` (about unit length). The
/// half vector h of that and of the view v lies along direction + v, of which the part across the
/// normal is that of direction - axis. In the lobe's formula alpha^2 grows by what the light's
/// spread, times d |h|^2 / d |direction|^2 near the axis, adds to the mean squared sine of h to the
/// normal; and the peak falls so that the lobe holds as much as before.
inline float mean_of_lobe(const Receiver& receiver, float3 direction,
                          float angular_spread) noexcept {
    const float3 normal = receiver.normal;
    const float3 from_axis = direction - receiver.axis;
    const float3 across = from_axis - normal * dot(normal, from_axis);
    const float across2 = dot(across, across);
    const float along = dot(normal, direction) + dot(normal, receiver.axis);
    const float inverse_half2 =
        1.0f / (along * along + receiver.from_all_sides + std::max(across2, kLeastTwiceHalf2));
    const float width = receiver.alpha2 + (0.125f + 0.5f * inverse_half2) * angular_spread;
    const float inverse = 1.0f / (width + (1.0f - receiver.alpha2) * (across2 * inverse_half2));
    return receiver.peak * receiver.alpha2 * width * inverse * inverse;
}

/// An estimate of g_i(x) of [TH16] Eq. 9, what the light gives a point but for visibility:
/// intensity by the mean squared distance, by the mean cosine at the emitter and the mean of cosine
/// times BSDF at the receiver. It is 0 only where the light cannot reach x. Largest cosines, as the
/// paper has them for the receiver, would favour near lights wherever they face.
inline float importance(const LightRecord& light, const Approach& way,
                        const Receiver& receiver) noexcept {
    const float spread = kSpread * light.radius * light.radius;
    const float mean_distance2 = way.distance2 + spread;
    if (!(mean_distance2 > kMinDistance2)) return 0.0f;
    const float inverse = 1.0f / std::sqrt(mean_distance2);

    const float3 normal = receiver.normal;
    float received = 1.0f;
    if (normal.x != 0.0f || normal.y != 0.0f || normal.z != 0.0f) {
        const float height = dot(normal, way.way);
        if (height + light.radius <= 0.0f) return 0.0f;
        received = mean_above(height, kHeightSpread * spread) * inverse;
    }
    if (receiver.has_lobe()) {
        received = receiver.diffuse * received +
                   mean_of_lobe(receiver, way.way * inverse, spread * inverse * inverse);
    }

    float emitter = 1.0f;
    if (light.is_flat()) {
        // One height above the plane of the light holds for all of it.
        float height = -dot(snorm_axis_of(light), way.way) * LightRecord::kSnorm;
        if (light.two_sided != 0) height = std::abs(height);
        emitter = std::min(height * inverse + kAxisRounding, 1.0f);
    } else if (light.is_glossy()) {
        const float3 axis = axis_of(light);
        const float fall_off =
            lobe_fall_off(axis * (1.0f / length(axis)), lobe_sharpness(light), way);
        emitter = 1.0f / (fall_off * fall_off);
    } else if (way.distance > light.radius && light.half_sine_o != LightRecord::kAllNormals) {
        emitter = emitter_bound(light, way);
    }
    if (!(emitter > 0.0f)) return 0.0f;
    return light.intensity * inverse * inverse * received * emitter;
}

}  // namespace lightcull
