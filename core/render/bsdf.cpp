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
    Bsdf b;
    b.frame_ = Basis(normal);
    b.outgoing_ = b.frame_.to_local(outgoing);
    b.diffuse_ = base_color;
    return b;
}

Bsdf Bsdf::metallic_roughness(const V3f& normal, const V3f& outgoing, const V3f& base_color,
                              float metallic, float roughness) noexcept {
    Bsdf b = diffuse(normal, outgoing, base_color * (1.0f - metallic));
    b.f0_ = V3f(kDielectricF0 * (1.0f - metallic)) + base_color * metallic;
    b.alpha_ = std::max(kMinAlpha, roughness * roughness);
    const V3f reflected = b.fresnel(b.outgoing_.z);
    const float diffuse = luminance(b.diffuse_ * (V3f(1.0f) - reflected));
    const float specular = luminance(reflected);
    b.specular_prob_ = diffuse > 0.0f ? std::clamp(specular / (specular + diffuse), kMinLobeProb,
                                                   1.0f - kMinLobeProb)
                                      : 1.0f;
    return b;
}

V3f Bsdf::fresnel(float cosine) const noexcept {
    return schlick(f0_, cosine);
}

float Bsdf::diffuse_part() const noexcept {
    const V3f reflected = specular_prob_ > 0.0f ? fresnel(outgoing_.z) : V3f(0.0f);
    return kInvPi * luminance(diffuse_ * (V3f(1.0f) - reflected));
}

GlossyLobe Bsdf::glossy_part() const noexcept {
    if (specular_prob_ == 0.0f) return {};
    // This is evaluate() in the mirror direction, where the half vector is the normal.
    const float masking = masking_over_two_cosines(outgoing_.z, alpha_);
    const float peak = ggx(0.0f, 1.0f, alpha_) * masking * masking * outgoing_.z;
    const V3f mirrored(-outgoing_.x, -outgoing_.y, outgoing_.z);
    return {to_float3(frame_.to_world(mirrored)), alpha_, peak * luminance(fresnel(outgoing_.z))};
}

BsdfValue Bsdf::evaluate(const V3f& incoming) const noexcept {
    return evaluate_local(frame_.to_local(incoming));
}

BsdfValue Bsdf::evaluate_local(const V3f& incoming) const noexcept {
    const float cosine = incoming.z;
    if (!(cosine > 0.0f)) return {};
    if (specular_prob_ == 0.0f) return {diffuse_ * (kInvPi * cosine), kInvPi * cosine};

    const V3f half = unit(outgoing_ + incoming);
    const V3f reflected = fresnel(outgoing_.dot(half));
    const float density = ggx(half.x * half.x + half.y * half.y, half.z * half.z, alpha_);
    const float view = masking_over_two_cosines(outgoing_.z, alpha_);
    const float light = masking_over_two_cosines(cosine, alpha_);
    // The density of visible normals is D G1(view) / (4 outgoing.z), and G1 = 2 outgoing.z * view.
    const float specular_pdf = 0.5f * density * view;
    return {diffuse_ * (V3f(1.0f) - reflected) * (kInvPi * cosine) +
                reflected * (density * view * light * cosine),
            specular_prob_ * specular_pdf + (1.0f - specular_prob_) * (kInvPi * cosine)};
}

BsdfSample Bsdf::sample(float lobe, const V2f& u) const noexcept {
    const V3f incoming = lobe < specular_prob_ ? sample_specular(u) : cosine_hemisphere(u);
    const BsdfValue v = evaluate_local(incoming);
    if (!(v.pdf > 0.0f)) return {};
    return {frame_.to_world(incoming), v.value / v.pdf, v.pdf};
}

V3f Bsdf::sample_specular(const V2f& u) const noexcept {
    // Stretch the view direction so that the surface becomes one of alpha 1, a hemisphere.
    const V3f view = unit(V3f(alpha_ * outgoing_.x, alpha_ * outgoing_.y, outgoing_.z));
    const float sine = std::sqrt(view.x * view.x + view.y * view.y);
    const V3f level = sine > 0.0f ? V3f(-view.y, view.x, 0.0f) / sine : V3f(1.0f, 0.0f, 0.0f);
    const V3f up = view.cross(level);
    // Seen from there the hemisphere is half a disk and, below it, half an ellipse: squeeze a disk.
    const V2f disk = uniform_disk(u);
    const float s = 0.5f * (1.0f + view.z);
    const float x = disk.x;
    const float y = (1.0f - s) * std::sqrt(std::max(0.0f, 1.0f - x * x)) + s * disk.y;
    const float z = std::sqrt(std::max(0.0f, 1.0f - x * x - y * y));
    const V3f normal = level * x + up * y + view * z;
    const V3f half = unit(V3f(alpha_ * normal.x, alpha_ * normal.y, std::max(1e-7f, normal.z)));
    return half * (2.0f * outgoing_.dot(half)) - outgoing_;
}

}  // namespace lightcull
