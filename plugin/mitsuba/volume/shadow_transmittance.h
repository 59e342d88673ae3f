#pragma once

#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/medium.h>
#include <mitsuba/render/scene.h>

#include "volume/flight.h"
#include "volume/scene_media.h"

namespace mitsuba::culling {

/// A shadow ray on its way to a light.
template <typename Float_, typename Spectrum_>
struct ShadowRay {
    using Float = Float_;
    using Spectrum = Spectrum_;
    MI_IMPORT_TYPES(Medium, MediumPtr, Sampler)

    Ray3f ray;
    MediumPtr medium;  ///< that it is in
    Spectrum transmittance;
    Mask active;
    Sampler* sampler;

    // NOLINTNEXTLINE(performance-noexcept-move-constructor)
    DRJIT_STRUCT(ShadowRay, ray, medium, transmittance, active, sampler)
};

/// The state of ratio tracking along a part of a shadow ray.
template <typename Float_, typename Spectrum_>
struct RatioTracking {
    using Float = Float_;
    using Spectrum = Spectrum_;
    MI_IMPORT_TYPES(Sampler)

    Float t;
    Spectrum transmittance;
    Mask active;
    Sampler* sampler;

    // NOLINTNEXTLINE(performance-noexcept-move-constructor)
    DRJIT_STRUCT(RatioTracking, t, transmittance, active, sampler)
};

/// Shadow rays through media, and through surfaces that let light straight through. Homogeneous
/// media have their transmittance, for others it is estimated by ratio tracking (Novak et al.
/// 2014).
template <typename Float, typename Spectrum>
class ShadowRays {
  public:
    MI_IMPORT_TYPES(Scene, Sampler, Medium, MediumPtr, BSDF, BSDFPtr)

    using State = ShadowRay<Float, Spectrum>;

    ShadowRays(const Scene* scene, const SceneMedia& media) : scene_(scene), media_(media) {}

    /// The share of light that comes from `to` to a point in `medium`.
    Spectrum transmittance(const Interaction3f& from, const Point3f& to, const MediumPtr& medium,
                           Sampler* sampler, const Mask& active) const {
        State shadow{from.spawn_ray_to(to), medium, Spectrum(1.0f), active, sampler};
        if (!media_.see_through) {
            const Mask arrives = active && !scene_->ray_test(shadow.ray, active);
            shadow.active = arrives;
            attenuate(shadow, shadow.ray.maxt);
            return dr::select(arrives, shadow.transmittance, 0.0f);
        }
        if constexpr (dr::is_jit_v<Float>) dr::make_opaque(shadow.transmittance);
        dr::tie(shadow) = dr::while_loop(
            dr::make_tuple(shadow), [](const State& state) { return state.active; },
            [this, to](State& state) { go_on(state, to); }, "lightcull: shadow rays");
        return dr::select(active, shadow.transmittance, 0.0f);
    }

  private:
    /// Takes shadow rays to the next surface, and through it.
    void go_on(State& shadow, const Point3f& to) const {
        const SurfaceInteraction3f si =
            scene_->ray_intersect(shadow.ray, +RayFlags::All, false, shadow.active);
        attenuate(shadow, dr::minimum(si.t, shadow.ray.maxt));
        const Mask meets = shadow.active && si.is_valid();
        if (dr::any_or<true>(meets)) {
            const BSDFPtr bsdf = si.bsdf();
            dr::masked(shadow.transmittance, meets) =
                shadow.transmittance * bsdf->eval_null_transmission(si, meets);
            const Mask changes = meets && si.is_medium_transition();
            dr::masked(shadow.medium, changes) = si.target_medium(to - si.p);
            // It is aimed anew: what Interaction::spawn_ray() moves it by must not take it past the
            // light, which would then hide itself.
            dr::masked(shadow.ray, meets) = si.spawn_ray_to(to);
        }
        shadow.active = meets && dr::any(shadow.transmittance != 0.0f);
    }

    /// Takes off what the medium takes on the first `length` of each ray.
    void attenuate(State& shadow, const Float& length) const {
        const Mask inside = shadow.active && shadow.medium != nullptr;
        if (!dr::any_or<true>(inside)) return;
        const Mask even = inside && shadow.medium->is_homogeneous();
        if (media_.homogeneous && dr::any_or<true>(even)) {
            const MediumInteraction3f mei =
                Flight<Float, Spectrum>::point(shadow.ray, 0.0f, shadow.medium);
            const Spectrum sigma_t = shadow.medium->get_majorant(mei, even);
            dr::masked(shadow.transmittance, even) =
                shadow.transmittance * dr::exp(-length * sigma_t);
        }
        if (media_.heterogeneous && dr::any_or<true>(inside && !even)) {
            track(shadow, length, inside && !even);
        }
    }

    void track(State& shadow, const Float& length, const Mask& active) const {
        using Tracking = RatioTracking<Float, Spectrum>;
        using Flights = Flight<Float, Spectrum>;
        Tracking start{0.0f, shadow.transmittance, active, shadow.sampler};
        if constexpr (dr::is_jit_v<Float>) dr::make_opaque(start.t);
        dr::tie(start) = dr::while_loop(
            dr::make_tuple(start), [](const Tracking& state) { return state.active; },
            [ray = shadow.ray, medium = shadow.medium, length](Tracking& state) {
                const Ray3f rest = Flights::rest(ray, state.t, length);
                const MediumInteraction3f mei =
                    Flights::sample(rest, medium, state.sampler, state.active);
                const Mask meets = state.active && mei.is_valid();
                const Float t = dr::select(meets, mei.t, rest.maxt);
                Spectrum weight = Flights::weight(mei, t, meets);
                dr::masked(weight, meets) = weight * mei.sigma_n;
                dr::masked(state.transmittance, state.active) = state.transmittance * weight;
                dr::masked(state.t, meets) = state.t + mei.t;
                state.active = meets && dr::any(state.transmittance != 0.0f);
            },
            "lightcull: ratio tracking");
        dr::masked(shadow.transmittance, active) = start.transmittance;
    }

    const Scene* scene_;
    SceneMedia media_;
};

}  // namespace mitsuba::culling
