#include "virtual_lights/volumes/bounding_volume.h"

#include <algorithm>
#include <cmath>

namespace lightcull {
namespace {

/// A margin for the rounding of an intensity, which with a narrow lobe grows by that of its half
/// vector.
constexpr float kMargin = 1.001f;
/// A margin of the longer axis, for the rounding of the centre.
constexpr float kEndMargin = 1.0f + 0x1p-18f;

/// A length greater than that between any two places of a scene; its square is finite.
constexpr float kFarthest = 4e15f;

/// A bound: a glossy light's intensity is this times GGX's D at half the angle from the mirror
/// direction, at most: [TH17] Eqs. 9 and 11. Its masking at the outgoing side, divided by 2, is at
/// most 1/2; its Fresnel term is largest on the horizon opposite, which the half vector sees at the
/// angle of (pi / 2 + theta_i) / 2.
float lobe_bound(const VirtualLight& light) noexcept {
    const float cosine = light.normal.dot(light.incoming);
    const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
    const V3f fresnel = schlick(light.f0, std::sqrt(std::max(0.0f, 0.5f * (1.0f - sine))));
    return 0.5f * luminance(light.strength * fresnel);
}

/// A Lambertian light's isosurface R sqrt(cosine) reaches farthest from its axis where the cosine
/// is 1 / sqrt(3): (4/27)^(1/4) R off it, (1/27)^(1/4) R along it. About that place on the axis the
/// sphere of the former radius holds all of it. ([TH17] section 6 prints (1/3)^(1/4) for the place:
/// that sphere would not hold the light itself.)
Spheroid offset_sphere(const VirtualLight& light, float range) noexcept {
    const float radius = range * std::pow(4.0f / 27.0f, 0.25f);
    const float along = range * std::pow(1.0f / 27.0f, 0.25f);
    return {light.position + light.normal * along, light.normal, radius, radius};
}

}  // namespace

V3f mirrored(const VirtualLight& light) noexcept {
    return light.normal * (2.0f * light.normal.dot(light.incoming)) - light.incoming;
}

float intensity_bound(const VirtualLight& light) noexcept {
    if (light.lobe != Lobe::kGlossy) return luminance(light.strength);
    return lobe_bound(light) * ggx(0.0f, 1.0f, light.alpha);
}

Spheroid bounding_volume(const VirtualLight& light, float scale, BoundingVolume kind) noexcept {
    const float range = std::min(kMargin * std::sqrt(scale * intensity_bound(light)), kFarthest);
    if (kind == BoundingVolume::kSphereAtLight) {
        return {light.position, light.normal, range, range};
    }
    if (light.lobe != Lobe::kGlossy) return offset_sphere(light, range);

    // The spheroid is that of [TH17] Eqs. 12 to 15: its r is alpha times the largest range.
    const float a2 = light.alpha * light.alpha;
    const V3f axis = mirrored(light);
    const float half_length = 0.5f * (1.0f + a2) * range * kEndMargin;
    const float radius = kind == BoundingVolume::kSpheroid ? light.alpha * range : half_length;
    return {light.position + axis * (0.5f * (1.0f - a2) * range), axis, half_length, radius};
}

}  // namespace lightcull
