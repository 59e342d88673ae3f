#include "render/bsdf.h"

#include "render/ggx.h"
#include "render/warp.h"

#include <algorithm>
#include <cmath>

namespace lightcull {
namespace {

constexpr float kDielectricF0 = 0.04f;
/// Neither lobe is sampled more rarely than this where both are there.
constexpr float kMinLobeProb = 0.1f;

}  // namespace

Bsdf Bsdf::diffuse(const V3f& normal, const V3f& outgoing, const V3f& base_color) noexcept {
    Bsdf b(normal, outgoing, base_color);
    b.reflected_diffuse_ = luminance(base_color);
    return b;
}

Bsdf Bsdf::metallic_roughness(const V3f& normal, const V3f& outgoing, const V3f& base_color,
                              float metallic, float roughness) noexcept {
    Bsdf b(normal, outgoing, base_color * (1.0f - metallic));
    b.f0_ = V3f(kDielectricF0 * (1.0f - metallic)) + base_color * metallic;
    b.alpha_ = std::max(kMinAlpha, roughness * roughness);
    b.cosine_ = normal.dot(outgoing);
    b.masking_ = masking_over_two_cosines(b.cosine_, b.alpha_);
    const V3f reflected = schlick(b.f0_, b.cosine_);
    const float diffuse = luminance(b.diffuse_ * (V3f(1.0f) - reflected));
    const float specular = luminance(reflected);
    b.reflected_diffuse_ = diffuse;
    b.reflected_specular_ = specular;
    b.specular_prob_ = diffuse > 0.0f ? std::clamp(specular / (specular + diffuse), kMinLobeProb,
                                                   1.0f - kMinLobeProb)
                                      : 1.0f;
    return b;
}

GlossyLobe Bsdf::glossy_part() const noexcept {
    if (specular_prob_ == 0.0f) return {};
    // This is evaluate() in the mirror direction, where the half vector is the normal.
    const float peak = ggx(0.0f, 1.0f, alpha_) * masking_ * masking_ * cosine_;
    const V3f mirrored = normal_ * (2.0f * cosine_) - outgoing_;
    return {to_float3(mirrored), alpha_, peak * reflected_specular_};
}

BsdfValue Bsdf::evaluate(const V3f& incoming) const noexcept {
    const float cosine = normal_.dot(incoming);
    if (!(cosine > 0.0f)) return {};
    const float cosine_pdf = kInvPi * cosine;
    if (specular_prob_ == 0.0f) return {diffuse_ * cosine_pdf, cosine_pdf};

    const V3f half = unit(outgoing_ + incoming);
    const V3f reflected = schlick(f0_, outgoing_.dot(half));
    const V3f sine = normal_.cross(half);
    const float half_cosine = normal_.dot(half);
    const float density = ggx(sine.dot(sine), half_cosine * half_cosine, alpha_);
    const float light = masking_over_two_cosines(cosine, alpha_);
    // The density of visible normals is D G1(view) / (4 outgoing.z), and G1 = 2 outgoing.z * view.
    const float specular_pdf = 0.5f * density * masking_;
    return {diffuse_ * (V3f(1.0f) - reflected) * cosine_pdf +
                reflected * (density * masking_ * light * cosine),
            specular_prob_ * specular_pdf + (1.0f - specular_prob_) * cosine_pdf};
}

BsdfSample Bsdf::sample(float lobe, const V2f& u) const noexcept {
    const Basis basis(normal_);
    if (lobe < specular_prob_) return with_weight(sample_specular(basis, u));
    const V3f local = cosine_hemisphere(u);
    const V3f incoming = basis.to_world(local);
    if (specular_prob_ > 0.0f) return with_weight(incoming);
    return local.z > 0.0f ? BsdfSample{incoming, diffuse_, kInvPi * local.z} : BsdfSample{};
}

BsdfSample Bsdf::with_weight(const V3f& incoming) const noexcept {
    const BsdfValue v = evaluate(incoming);
    if (!(v.pdf > 0.0f)) return {};
    return {incoming, v.value * (1.0f / v.pdf), v.pdf};
}

V3f Bsdf::sample_specular(const Basis& basis, const V2f& u) const noexcept {
    // Stretch the view direction so that the surface becomes one of alpha 1, a hemisphere.
    const V3f outgoing = basis.to_local(outgoing_);
    const V3f view = unit(V3f(alpha_ * outgoing.x, alpha_ * outgoing.y, outgoing.z));
    const float sine = std::sqrt(view.x * view.x + view.y * view.y);
    const V3f level =
        sine > 0.0f ? V3f(-view.y, view.x, 0.0f) * (1.0f / sine) : V3f(1.0f, 0.0f, 0.0f);
    const V3f up = view.cross(level);
    // Seen from there the hemisphere is half a disk and, below it, half an ellipse: squeeze a disk.
    const V2f disk = uniform_disk(u);
    const float s = 0.5f * (1.0f + view.z);
    const float x = disk.x;
    const float y = (1.0f - s) * std::sqrt(std::max(0.0f, 1.0f - x * x)) + s * disk.y;
    const float z = std::sqrt(std::max(0.0f, 1.0f - x * x - y * y));
    const V3f normal = level * x + up * y + view * z;
    const V3f half = unit(V3f(alpha_ * normal.x, alpha_ * normal.y, std::max(1e-7f, normal.z)));
    return basis.to_world(half * (2.0f * outgoing.dot(half)) - outgoing);
}

}  // namespace lightcull
