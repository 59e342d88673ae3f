#pragma once

#include "base/core_export.h"
#include "render/vec.h"

#include <lightcull/light_sampler.h>

namespace lightcull {

/// GGX's alpha is not let below this (a perceptual roughness of 0.032), so that a mirror is a
/// narrow lobe like any other and needs no case of its own.
inline constexpr float kMinAlpha = 1e-3f;

/// A BSDF in one direction.
struct BsdfValue {
    V3f value{0.0f};   ///< BSDF times the cosine to the shading normal
    float pdf = 0.0f;  ///< density of sample() for that direction, per solid angle
};

struct BsdfSample {
    V3f direction{0.0f};  ///< sampled direction, unit length
    V3f weight{0.0f};     ///< value / pdf
    float pdf = 0.0f;     ///< density, as in BsdfValue; 0: absorbed
};

/// How a surface point scatters light that leaves it towards `outgoing`.
///
/// Diffuse surfaces: base_color / pi. Metallic-roughness surfaces: glTF 2.0, appendix B: with F
/// Schlick's Fresnel term at the half vector, (1 - F) (1 - metallic) base_color / pi + F D V, where
/// D is GGX and V Smith's masking-shadowing in its separable form, the form that the appendix
/// prints. Both are sampled by one mixture: cosine-weighted, and visible normals (Heitz 2018,
/// "Sampling the GGX Distribution of Visible Normals").
class LIGHTCULL_CORE_EXPORT Bsdf {
  public:
    Bsdf() noexcept : Bsdf(V3f(0.0f), V3f(0.0f), V3f(0.0f)) {}

    /// normal and outgoing: unit length, on the same side.
    static Bsdf diffuse(const V3f& normal, const V3f& outgoing, const V3f& base_color) noexcept;
    static Bsdf metallic_roughness(const V3f& normal, const V3f& outgoing, const V3f& base_color,
                                   float metallic, float roughness) noexcept;

    /// incoming: unit length, towards where light comes from. The value is 0 below the shading
    /// normal.
    BsdfValue evaluate(const V3f& incoming) const noexcept;

    /// lobe in [0, 1), u in [0, 1)^2.
    BsdfSample sample(float lobe, const V2f& u) const noexcept;

    const V3f& normal() const noexcept { return normal_; }

    /// The numbers that a BSDF is made of: the albedo under the specular layer, and the reflectance
    /// at normal incidence and alpha of that layer, where there is one.
    const V3f& diffuse_albedo() const noexcept { return diffuse_; }
    const V3f& f0() const noexcept { return f0_; }
    float alpha() const noexcept { return alpha_; }
    bool is_specular() const noexcept { return specular_prob_ > 0.0f; }
    /// True if it scatters so widely that its samples tell little of where light comes from.
    bool is_broad() const noexcept {
        constexpr float kBroad = 0.25f;
        return !is_specular() || alpha_ >= kBroad;
    }

    /// The two parts of the BSDF as a light sampler takes them (ShadingPoint::diffuse and lobe),
    /// 1/sr by luminance.
    float diffuse_part() const noexcept { return kInvPi * reflected_diffuse_; }
    GlossyLobe glossy_part() const noexcept;

  private:
    Bsdf(const V3f& normal, const V3f& outgoing, const V3f& diffuse) noexcept
        : normal_(normal), outgoing_(outgoing), diffuse_(diffuse) {}
    /// A sample of this direction.
    BsdfSample with_weight(const V3f& incoming) const noexcept;
    V3f sample_specular(const Basis& basis, const V2f& u) const noexcept;

    V3f normal_, outgoing_;
    V3f diffuse_;   // diffuse albedo
    V3f f0_{0.0f};  // reflectance at normal incidence
    float alpha_ = 1.0f;
    float specular_prob_ = 0.0f;  // 0: there is no specular lobe, and no use for what follows
    float cosine_ = 0.0f;         // cosine of `outgoing` to the normal
    float masking_ = 0.0f;        // masking_over_two_cosines() of it
    // Luminances of what the lobes reflect of light that comes from the mirror direction.
    float reflected_diffuse_ = 0.0f, reflected_specular_ = 0.0f;
};

}  // namespace lightcull
