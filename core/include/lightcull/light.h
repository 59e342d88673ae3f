#pragma once

#include <lightcull/float3.h>

namespace lightcull {

/// What a sampler knows of one light: bounds, the directions it emits into, and how strongly.
///
/// The directions follow Conty Estevez & Kulla 2018: every normal of the light lies within
/// theta_o of `axis`, and it emits up to theta_e from its normal, with the cosine of that angle.
/// A cos_theta_o of exactly 1 says that all of the light lies in one plane through `center`.
///
/// | light                | axis      | cos_theta_o | cos_theta_e |
/// |----------------------|-----------|-------------|-------------|
/// | flat, one-sided      | normal    | 1           | 0           |
/// | point, sphere        | any       | -1          | 0           |
/// | spot                 | direction | cos(inner)  | cos(outer - inner) |
struct Light {
    float3 center;              ///< centre of the bounding sphere, metres
    float radius = 0.0f;        ///< radius of the bounding sphere, metres, >= 0
    float3 axis{0, 0, 1};       ///< axis of the cone of normals, unit length
    float cos_theta_o = -1.0f;  ///< cosine of the half-angle of the cone of normals, [-1, 1]
    float cos_theta_e = 0.0f;   ///< cosine of the largest angle to a normal, [0, 1]
    float intensity = 0.0f;     ///< peak radiant intensity, W/sr, luminance-weighted, >= 0:
                                ///< Lbar_i A_i of [TH16] Eq. 7, max I_i of Eq. 6
    bool two_sided = false;     ///< emits about -axis as it does about axis
};

/// A triangle that emits `radiance` (mean over its area, luminance, W/(m^2 sr)) on the side from
/// which a, b, c (metres) run anticlockwise, or on both. A triangle without area gives a light of
/// intensity 0.
Light triangle_light(float3 a, float3 b, float3 c, float radiance, bool two_sided = false) noexcept;

/// A point that emits `intensity` (luminance, W/sr) in all directions.
Light point_light(float3 position, float intensity) noexcept;

/// A point that emits `intensity` (luminance, W/sr) up to `inner` from `direction` (any length but
/// 0) and less and less to nothing at `outer`; radians, 0 <= inner <= outer <= pi.
Light spot_light(float3 position, float3 direction, float intensity, float inner,
                 float outer) noexcept;

/// A light of which only a box (metres), a cone of directions and the radiant power (luminance, W)
/// are known. The cone is that of Light.
Light bounded_light(float3 box_min, float3 box_max, float3 axis, float cos_theta_o,
                    float cos_theta_e, bool two_sided, float power) noexcept;

}  // namespace lightcull
