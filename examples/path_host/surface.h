#pragma once

// This is how a surface reflects: a diffuse part, and a GGX lobe with Schlick's Fresnel term.
// Nothing here knows of light sampling.

#include <algorithm>

#include "scene.h"

namespace host {

/// A material as seen from a direction.
class Surface {
  public:
    Surface() : frame_({0, 0, 1}) {}
    /// view: direction away from the surface, unit length.
    Surface(const Material& material, float3 normal, float3 view)
        : material_(material), frame_(normal), view_(frame_.to_local(view)) {
        view_.z = std::max(view_.z, 1e-3f);
        const float glossy = luminance(fresnel(view_.z)), diffuse = luminance(material.albedo);
        chance_of_lobe_ = glossy / (glossy + diffuse);
    }

    const Material& material() const { return material_; }
    float3 normal() const { return frame_.z; }
    float cos_view() const { return view_.z; }
    float3 mirror_direction() const { return frame_.to_world({-view_.x, -view_.y, view_.z}); }

    /// Schlick's approximation.
    float3 fresnel(float cosine) const {
        if (luminance(material_.reflectance) == 0.0f) return {0, 0, 0};
        const float rest = std::pow(1.0f - cosine, 5.0f);
        return (1.0f - rest) * material_.reflectance + rest * float3{1, 1, 1};
    }
    /// D of GGX, for the cosine of a half vector to the normal.
    float ggx(float cosine) const {
        const float alpha2 = material_.alpha * material_.alpha;
        const float t = cosine * cosine * (alpha2 - 1.0f) + 1.0f;
        return alpha2 / (kPi * t * t);
    }

    /// The BSDF times the cosine of a direction, which points away from the surface.
    float3 bsdf_cosine(float3 direction) const {
        const float3 light = frame_.to_local(direction);
        if (light.z <= 0.0f) return {0, 0, 0};
        const float3 half = normalize(light + view_);
        const float g = 1.0f / (1.0f + lambda(view_.z) + lambda(light.z));
        const float lobe = ggx(half.z) * g / (4.0f * view_.z);
        return light.z / kPi * material_.albedo + lobe * fresnel(dot(view_, half));
    }

    /// A direction for a ray that leaves the surface. It may point below the surface.
    float3 sample(Random& random) const {
        if (random.uniform() >= chance_of_lobe_) return frame_.to_world(cosine_direction(random));
        // Visible half vectors, by spherical caps (Dupuy & Benyoub 2023).
        const float alpha = material_.alpha;
        const float3 stretched = normalize({alpha * view_.x, alpha * view_.y, view_.z});
        const float angle = 2.0f * kPi * random.uniform();
        const float z = (1.0f - random.uniform()) * (1.0f + stretched.z) - stretched.z;
        const float radius = std::sqrt(std::clamp(1.0f - z * z, 0.0f, 1.0f));
        const float3 cap{radius * std::cos(angle), radius * std::sin(angle), z};
        const float3 sum = cap + stretched;
        const float3 half = normalize({alpha * sum.x, alpha * sum.y, sum.z});
        return frame_.to_world(2.0f * dot(view_, half) * half - view_);
    }

    /// The density with which sample() gives a direction, by solid angle.
    float pdf(float3 direction) const {
        const float3 light = frame_.to_local(direction);
        if (light.z <= 0.0f) return 0.0f;
        const float3 half = normalize(light + view_);
        const float lobe = ggx(half.z) / ((1.0f + lambda(view_.z)) * 4.0f * view_.z);
        return chance_of_lobe_ * lobe + (1.0f - chance_of_lobe_) * light.z / kPi;
    }

  private:
    /// Smith's Lambda of GGX.
    float lambda(float cosine) const {
        const float alpha2 = material_.alpha * material_.alpha, cosine2 = cosine * cosine;
        return 0.5f * (std::sqrt(1.0f + alpha2 * (1.0f - cosine2) / cosine2) - 1.0f);
    }

    Material material_{};
    Frame frame_;
    float3 view_;  // in the frame, above the surface
    float chance_of_lobe_ = 0.0f;
};

}  // namespace host
