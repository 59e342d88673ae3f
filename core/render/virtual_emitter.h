#pragma once

#include "render/ggx.h"
#include "render/vec.h"

#include <cstdint>

namespace lightcull {

/// The part of a surface's BSDF by which a virtual light sends light out. A glossy surface gives
/// two lights: [TH17] culls diffuse and glossy ones by volumes of their own.
enum class Lobe : std::uint32_t {
    kDiffuse,     ///< Lambert
    kUnderGloss,  ///< Lambert under a specular layer: the light that the layer does not reflect
    kGlossy,      ///< GGX
};

/// A point of a surface that light has come to and leaves again ([TH17] Eq. 4).
struct VirtualLight {
    V3f position;  ///< place where shadow rays end: just off the surface
    V3f normal;    ///< normal on the lit side, unit length
    V3f incoming;  ///< direction towards where the light comes from, unit length
    V3f strength;  ///< W/sr: the flux that has come, times the part of the lobe that does not
                   ///< depend on the outgoing direction (albedo / pi, or Smith's masking)
    V3f f0;  ///< reflectance at normal incidence of the specular layer, for lobes that have one
    float alpha;  ///< GGX's alpha of kGlossy, (0, 1]
    Lobe lobe;
};

/// The radiant intensity into a direction (unit length): [TH17] Eqs. 4 and 6. It is 0 below the
/// surface.
inline V3f intensity(const VirtualLight& light, const V3f& outgoing) noexcept {
    const float cosine = light.normal.dot(outgoing);
    if (!(cosine > 0.0f)) return V3f(0.0f);
    if (light.lobe == Lobe::kDiffuse) return light.strength * cosine;

    const V3f sum = light.incoming + outgoing;
    const V3f half = unit(sum);
    const V3f reflected = schlick(light.f0, outgoing.dot(half));
    if (light.lobe == Lobe::kUnderGloss) return light.strength * (V3f(1.0f) - reflected) * cosine;

    const V3f across = half.cross(light.normal);
    const float half_cosine = half.dot(light.normal);
    const float density = ggx(across.dot(across), half_cosine * half_cosine, light.alpha);
    return light.strength * reflected *
           (density * masking_over_two_cosines(cosine, light.alpha) * cosine);
}

}  // namespace lightcull
