#pragma once

#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/scene.h>

#include <cstdint>

namespace mitsuba::culling {

/// What a light sampler is told of a surface point besides its place. The fields mean what those of
/// lightcull::ShadingPoint and its lobe mean.
template <typename Float_>
struct Receiver {
    using Float = Float_;
    Vector<Float, 3> normal;
    Float diffuse;
    Vector<Float, 3> axis;  ///< the lobe's, as are alpha and peak
    Float alpha, peak;

    // NOLINTNEXTLINE(performance-noexcept-move-constructor)
    DRJIT_STRUCT(Receiver, normal, diffuse, axis, alpha, peak)
};

/// Whether anything in the scene has a glossy lobe.
template <typename Float, typename Spectrum>
bool has_glossy_surfaces(const Scene<Float, Spectrum>* scene) {
    for (const auto& shape : scene->shapes()) {
        if (shape->bsdf() && has_flag(shape->bsdf()->flags(), BSDFFlags::GlossyReflection)) {
            return true;
        }
    }
    return false;
}

/// The receiver at a surface point, with the lobe of its BSDF left out.
template <typename Float, typename Spectrum>
Receiver<Float> matte_receiver(const SurfaceInteraction<Float, Spectrum>& si,
                               const dr::uint32_array_t<Float>& flags) {
    using Vector3f = Vector<Float, 3>;
    // Light from behind counts for a BSDF that has one of these.
    constexpr std::uint32_t kBothSides =
        BSDFFlags::DiffuseTransmission | BSDFFlags::GlossyTransmission;
    const Vector3f facing(dr::mulsign(si.sh_frame.n, Frame<Float>::cos_theta(si.wi)));
    Receiver<Float> receiver;
    receiver.normal = dr::select((flags & kBothSides) != 0u, Vector3f(0.0f), facing);
    receiver.diffuse = 1.0f;
    receiver.axis = Vector3f(0.0f, 0.0f, 1.0f);
    receiver.alpha = 1.0f;
    receiver.peak = 0.0f;
    return receiver;
}

/// The receiver at a surface point with the lobe of its BSDF, as far as Mitsuba's interface shows
/// it: what the glossy part is worth in the mirror direction, and how densely it is sampled there.
/// With microfacets of roughness alpha that density is D(n) / (4 cos), and D(n) = 1 / (pi alpha^2).
template <typename Float, typename Spectrum, typename BSDFPtr>
Receiver<Float> glossy_receiver(const SurfaceInteraction<Float, Spectrum>& si, const BSDFPtr& bsdf,
                                const dr::uint32_array_t<Float>& flags,
                                const dr::mask_t<Float>& active) {
    using Vector3f = Vector<Float, 3>;
    // A lobe of another form must not hide a light that matters.
    constexpr float kGuard = 0.1f;
    constexpr float kMinAlpha = 1e-3f;

    Receiver<Float> receiver = matte_receiver<Float, Spectrum>(si, flags);
    const auto glossy =
        active && has_flag(flags, BSDFFlags::GlossyReflection) && dr::any(receiver.normal != 0.0f);
    const Vector3f normal = bsdf->sh_frame(si, glossy).n, view = si.to_world(si.wi);
    const Float cosine = dr::dot(normal, view);
    const Vector3f mirror = 2.0f * cosine * normal - view;
    BSDFContext context;
    context.type_mask = +BSDFFlags::Glossy;
    const auto [value, pdf] = bsdf->eval_pdf(context, si, si.to_local(mirror), glossy);
    const Float peak = dr::mean(unpolarized_spectrum(value));
    const auto has_diffuse = glossy && has_flag(flags, BSDFFlags::DiffuseReflection);
    const Float diffuse =
        dr::mean(unpolarized_spectrum(bsdf->eval_diffuse_reflectance(si, has_diffuse)));

    const auto found = glossy && peak > 0.0f && pdf > 0.0f && dr::isfinite(peak / pdf);
    const Float alpha = dr::rsqrt(4.0f * dr::Pi<Float> * pdf * dr::abs(cosine));
    dr::masked(receiver.diffuse, found) =
        dr::InvPi<Float> * (dr::select(has_diffuse, diffuse, 0.0f) + kGuard * peak / pdf);
    dr::masked(receiver.axis, found) = mirror;
    dr::masked(receiver.alpha, found) = dr::clip(alpha, kMinAlpha, 1.0f);
    dr::masked(receiver.peak, found) = peak;
    return receiver;
}

}  // namespace mitsuba::culling
