#pragma once

#include <lightcull/export.h>
#include <lightcull/float3.h>

namespace lightcull {

/// What a sampler knows of one light: bounds, the directions it emits into, and how strongly.
///
/// The directions follow Conty Estevez & Kulla 2018: every normal of the light lies within
/// theta_o of `axis`, and it emits up to theta_e from its normal, with the cosine of that angle.
/// A cos_theta_o of exactly 1 says that all of the light lies in one plane through `center`. Both
/// cosines may have been rounded to floats: a sampler takes the cones that they then may stand for.
///
/// | light                | axis      | cos_theta_o | cos_theta_e |
/// |----------------------|-----------|-------------|-------------|
/// | flat, one-sided      | normal    | 1           | 0           |
/// | point, sphere, tube  | any       | -1          | 0           |
/// | spot                 | direction | cos(inner)  | cos(outer - inner) |
/// | glossy point         | direction | -1          | 0           |
/// | directional          | direction | -1          | 0           |
struct Light {
    float3 center;              ///< centre of the bounding sphere, metres
    float radius = 0.0f;        ///< radius of the bounding sphere, metres, >= 0
    float3 axis{0, 0, 1};       ///< axis of the cone of normals, unit length
    float cos_theta_o = -1.0f;  ///< cosine of the half-angle of the cone of normals, [-1, 1]
    float cos_theta_e = 0.0f;   ///< cosine of the largest angle to a normal, [0, 1]
    float intensity = 0.0f;     ///< peak radiant intensity, W/sr, luminance-weighted, >= 0:
                                ///< Lbar_i A_i of [TH16] Eq. 7, max I_i of Eq. 6; of a directional
                                ///< light irradiance, W/m^2
    bool two_sided = false;     ///< the light emits about -axis as it does about axis
    float lobe_alpha = 0.0f;    ///< alpha of a glossy point, [1e-3, 1]: see glossy_point_light(); 0
                                ///< for all others
    bool directional = false;   ///< the light is infinitely far and shines along `axis`: see
                                ///< directional_light(); `center` does not matter
};

/// A triangle that emits `radiance` (mean over its area, luminance, W/(m^2 sr)) on the side from
/// which a, b, c (metres) run anticlockwise, or on both. A triangle without area gives a light of
/// intensity 0.
LIGHTCULL_EXPORT Light triangle_light(float3 a, float3 b, float3 c, float radiance,
                                      bool two_sided = false) noexcept;

/// A sphere that emits `radiance` (luminance, W/(m^2 sr)) from all of its outside. center, radius:
/// metres.
LIGHTCULL_EXPORT Light sphere_light(float3 center, float radius, float radiance) noexcept;

/// A disc that emits `radiance` (luminance, W/(m^2 sr)) on the side of `normal` (any length but 0),
/// or on both. center, radius: metres.
LIGHTCULL_EXPORT Light disc_light(float3 center, float3 normal, float radius, float radiance,
                                  bool two_sided = false) noexcept;

/// A tube from a to b (metres) that emits `radiance` (luminance, W/(m^2 sr)) from its side, but not
/// from its ends. The tube counts as shining everywhere as it does across its axis; a tube that is
/// long beside its distance to what it lights is better cut into several.
LIGHTCULL_EXPORT Light cylinder_light(float3 a, float3 b, float radius, float radiance) noexcept;

/// A point that emits `intensity` (luminance, W/sr) in all directions.
LIGHTCULL_EXPORT Light point_light(float3 position, float intensity) noexcept;

/// A point that emits `intensity` (luminance, W/sr) up to `inner` from `direction` (any length but
/// 0) and less and less to nothing at `outer`; radians, 0 <= inner <= outer <= pi.
LIGHTCULL_EXPORT Light spot_light(float3 position, float3 direction, float intensity, float inner,
                                  float outer) noexcept;

/// A point that emits with the cosine to `normal` (unit length), `intensity` (luminance, W/sr)
/// along it and nothing behind it: a diffuse virtual light.
LIGHTCULL_EXPORT Light diffuse_point_light(float3 position, float3 normal,
                                           float intensity) noexcept;

/// A point that emits `intensity` (luminance, W/sr) into `direction` (unit length) and less about
/// it: the intensity falls as GGX's D of `alpha` does with half the angle h to the direction, by
/// the square of 1 + (1 / alpha^2 - 1) sin^2 h. That bounds what a glossy virtual light emits
/// ([TH17] Eqs. 9 to 12).
LIGHTCULL_EXPORT Light glossy_point_light(float3 position, float3 direction, float intensity,
                                          float alpha) noexcept;

/// A sun: parallel light from infinity that goes into `direction` (any length but 0). It gives
/// `irradiance` (luminance, W/m^2) to a surface that faces it.
LIGHTCULL_EXPORT Light directional_light(float3 direction, float irradiance) noexcept;

/// A light of which only a box (metres), a cone of directions and the radiant power (luminance, W)
/// are known. The cone is that of Light.
LIGHTCULL_EXPORT Light bounded_light(float3 box_min, float3 box_max, float3 axis, float cos_theta_o,
                                     float cos_theta_e, bool two_sided, float power) noexcept;

}  // namespace lightcull
