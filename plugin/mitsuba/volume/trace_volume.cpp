#include "volume/trace_volume.h"

#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/medium.h>
#include <mitsuba/render/phase.h>

#include "arrays/variants.h"
#include "paths/mis_weight.h"
#include "scene/surface_receiver.h"
#include "volume/flight.h"
#include "volume/scene_media.h"
#include "volume/shadow_transmittance.h"

namespace mitsuba::culling {
namespace {

/// The state of paths between two of their vertices.
template <typename Float_, typename Spectrum_>
struct VolumeState {
    using Float = Float_;
    using Spectrum = Spectrum_;
    MI_IMPORT_TYPES(Sampler, Medium, MediumPtr)

    Ray3f ray;
    MediumPtr medium;  ///< that the ray is in
    Spectrum throughput, result;
    Float eta;
    UInt32 depth;  ///< how often it was scattered
    Mask valid;
    // Where it was scattered last, for the weight of what its ray hits.
    Interaction3f last;
    Receiver<Float> receiver;
    Float pdf;
    Mask weigh;
    Mask active;
    Sampler* sampler;

    // NOLINTNEXTLINE(performance-noexcept-move-constructor)
    DRJIT_STRUCT(VolumeState, ray, medium, throughput, result, eta, depth, valid, last, receiver,
                 pdf, weigh, active, sampler)
};

/// The state of delta tracking along a ray.
template <typename Float_, typename Spectrum_>
struct DeltaTracking {
    using Float = Float_;
    using Spectrum = Spectrum_;
    MI_IMPORT_TYPES(Sampler)

    Float t;
    Spectrum throughput;
    Mask scatters, active;
    Sampler* sampler;

    // NOLINTNEXTLINE(performance-noexcept-move-constructor)
    DRJIT_STRUCT(DeltaTracking, t, throughput, scatters, active, sampler)
};

/// A step of all paths: through a medium, to where it scatters or a surface is, and on from there.
/// Where light is added, and in depths, roulette and weights, it does what Mitsuba's `volpath`
/// does.
template <typename Float, typename Spectrum>
class VolumeStep {
  public:
    MI_IMPORT_TYPES(Scene, Sampler, Emitter, EmitterPtr, BSDF, BSDFPtr, Medium, MediumPtr,
                    PhaseFunction, PhaseFunctionPtr, PhaseFunctionContext)

    using State = VolumeState<Float, Spectrum>;
    using Sample = LightSample<Float, Spectrum>;
    using Flights = Flight<Float, Spectrum>;

    VolumeStep(const PathContext<Float, Spectrum>& context,
               const VolumeLights<Float, Spectrum>& lights, const SceneMedia& media)
        : context_(context), lights_(lights), media_(media), shadow_rays_(context.scene, media) {}

    State start(const RayDifferential3f& rays, const Medium* medium, Sampler* sampler,
                const Mask& active) const {
        const Mask valid = !context_.hide_emitters && context_.scene->environment() != nullptr;
        State state{Ray3f(rays),
                    medium,
                    1.0f,
                    0.0f,
                    1.0f,
                    0u,
                    valid,
                    dr::zeros<Interaction3f>(),
                    dr::zeros<Receiver<Float>>(),
                    1.0f,
                    false,
                    active,
                    sampler};
        // What never varies would be taken for a constant of the loop.
        if constexpr (dr::is_jit_v<Float>) {
            dr::make_opaque(state.throughput, state.result, state.eta, state.depth, state.valid,
                            state.last, state.receiver, state.pdf, state.weigh);
        }
        return state;
    }

    void operator()(State& paths) const {
        SurfaceInteraction3f si;
        MediumInteraction3f mei;
        const Mask scatters = fly(paths, si, mei);
        const Mask arrives = paths.active && !scatters;
        add_emission(paths, si, arrives);
        const Mask goes_on = paths.depth + 1u < context_.max_depth;
        scatter(paths, si, mei, arrives && si.is_valid(), scatters && goes_on, goes_on);
    }

  private:
    /// Takes paths through the medium that they are in: finds the surface that each arrives at, or
    /// where the medium scatters it first, and says for which paths that is.
    Mask fly(State& paths, SurfaceInteraction3f& si, MediumInteraction3f& mei) const {
        const Mask inside = paths.active && paths.medium != nullptr;
        Mask scatters = false, even = false;
        Float t = 0.0f;
        auto met = dr::zeros<MediumInteraction3f>();
        Ray3f ray = paths.ray;
        if (media_.homogeneous && dr::any_or<true>(inside)) {
            even = inside && paths.medium->is_homogeneous();
        }
        if (media_.homogeneous && dr::any_or<true>(even)) {
            met = Flights::sample(ray, paths.medium, paths.sampler, even);
            dr::masked(ray.maxt, even && met.is_valid()) = met.t;
        }
        si = context_.scene->ray_intersect(ray, +RayFlags::All, paths.depth == 0u, paths.active);
        if (media_.homogeneous && dr::any_or<true>(even)) {
            scatters = even && met.is_valid() && !(si.t < met.t);
            Spectrum weight = Flights::weight(met, dr::minimum(met.t, si.t), scatters);
            dr::masked(weight, scatters) = weight * met.sigma_s;
            dr::masked(paths.throughput, even) = paths.throughput * weight;
            t = met.t;
        }
        const Mask uneven = inside && !even;
        if (media_.heterogeneous && dr::any_or<true>(uneven)) {
            track(paths, si.t, uneven, t, scatters);
        }
        mei = Flights::point(paths.ray, dr::select(scatters, t, 0.0f), paths.medium);
        return scatters;
    }

    /// Does so where the medium is heterogeneous.
    void track(State& paths, const Float& end, const Mask& active, Float& t, Mask& scatters) const {
        using Tracking = DeltaTracking<Float, Spectrum>;
        Tracking state{0.0f, paths.throughput, false, active, paths.sampler};
        if constexpr (dr::is_jit_v<Float>) dr::make_opaque(state.t, state.scatters);
        dr::tie(state) = dr::while_loop(
            dr::make_tuple(state), [](const Tracking& state) { return state.active; },
            [ray = paths.ray, medium = paths.medium, end](Tracking& state) {
                const Ray3f rest = Flights::rest(ray, state.t, end);
                const MediumInteraction3f mei =
                    Flights::sample(rest, medium, state.sampler, state.active);
                const Mask meets = state.active && mei.is_valid();
                Spectrum weight = Flights::weight(mei, dr::select(meets, mei.t, rest.maxt), meets);
                const Float null_prob = dr::mean(mei.sigma_n / mei.combined_extinction);
                const Mask is_null = state.sampler->next_1d(state.active) < null_prob;
                dr::masked(weight, meets) = weight * dr::select(is_null, mei.sigma_n / null_prob,
                                                                mei.sigma_s / (1.0f - null_prob));
                dr::masked(state.throughput, state.active) = state.throughput * weight;
                dr::masked(state.t, meets) = state.t + mei.t;
                state.scatters |= meets && !is_null;
                state.active = meets && is_null && dr::any(state.throughput != 0.0f);
            },
            "lightcull: delta tracking");
        dr::masked(paths.throughput, active) = state.throughput;
        dr::masked(t, active) = state.t;
        scatters |= active && state.scatters;
    }

    /// Adds the light of the surfaces that paths arrive at, or of the environment.
    void add_emission(State& paths, const SurfaceInteraction3f& si, const Mask& active) const {
        const EmitterPtr emitter = si.emitter(context_.scene, active);
        Mask shines = active && emitter != nullptr;
        if (context_.hide_emitters) {
            shines &= paths.depth != 0u;
        } else {
            paths.valid |= shines;
        }
        if (!dr::any_or<true>(shines)) return;
        const Mask weigh = shines && paths.weigh;
        Float weight = 1.0f;
        if (dr::any_or<true>(weigh)) {
            const auto place_of = [&](const UInt32& light, const Mask& on_triangle) {
                return lights_.place_of(si.p, light, on_triangle);
            };
            const Float pdf = lights_.pdf(paths.last, paths.receiver, si, emitter, place_of, weigh);
            dr::masked(weight, weigh) = mis_weight(paths.pdf, pdf);
        }
        dr::masked(paths.result, shines) =
            paths.result + paths.throughput * emitter->eval(si, shines) * weight;
    }

    /// Adds direct light, and scatters paths on surfaces and in media. Where a path may not be
    /// scattered once more, surfaces may still let it straight through.
    void scatter(State& paths, const SurfaceInteraction3f& si, const MediumInteraction3f& mei,
                 const Mask& on_surface, const Mask& in_medium, const Mask& goes_on) const {
        BSDFPtr bsdf = nullptr;
        UInt32 flags(0);
        if (dr::any_or<true>(on_surface)) {
            bsdf = si.bsdf();
            flags = bsdf->flags(on_surface);
        }
        const Mask smooth = on_surface && goes_on && has_flag(flags, BSDFFlags::Smooth);
        Mask samples = smooth;
        PhaseFunctionPtr phase = nullptr;
        if (dr::any_or<true>(in_medium)) {
            samples |= in_medium && paths.medium->use_emitter_sampling();
            phase = paths.medium->phase_function();
            dr::masked(phase, !in_medium) = nullptr;
        }
        Interaction3f point(si);
        dr::masked(point, in_medium) = Interaction3f(mei);
        const Receiver<Float> receiver = this->receiver(si, bsdf, flags, smooth);
        const Vertex vertex{si, mei, point, bsdf, phase, smooth, in_medium};
        if (dr::any_or<true>(samples)) {
            if (lights_.has_lights()) {
                add_light(paths, vertex,
                          lights_.sample_light(point, receiver, paths.sampler, samples, samples));
            }
            if (lights_.has_unplaced()) {
                add_light(paths, vertex,
                          lights_.sample_unplaced(point, paths.sampler, samples, samples));
            }
        }
        advance(paths, vertex, receiver, on_surface, samples, goes_on);
    }

    /// Where a path is scattered.
    struct Vertex {
        const SurfaceInteraction3f& si;
        const MediumInteraction3f& mei;
        const Interaction3f& point;  ///< either
        BSDFPtr bsdf;
        PhaseFunctionPtr phase;
        Mask smooth;     ///< on a surface, which scatters into more than single directions
        Mask in_medium;  ///< in a medium
    };

    /// What is known of the vertices that are on surfaces; all others are lit from all sides.
    Receiver<Float> receiver(const SurfaceInteraction3f& si, const BSDFPtr& bsdf,
                             const UInt32& flags, const Mask& smooth) const {
        auto receiver = volume_receiver();
        if (dr::any_or<true>(smooth)) {
            dr::masked(receiver, smooth) =
                context_.has_lobes ? glossy_receiver<Float, Spectrum>(si, bsdf, flags, smooth)
                                   : matte_receiver<Float, Spectrum>(si, flags);
        }
        return receiver;
    }

    static Receiver<Float> volume_receiver() {
        return {Vector3f(0.0f), Float(1.0f), Vector3f(0.0f, 0.0f, 1.0f), Float(1.0f), Float(0.0f)};
    }

    /// Adds the light of a sample, as far as it arrives.
    void add_light(State& paths, const Vertex& at, const Sample& sample) const {
        Spectrum value(0.0f);
        Float pdf = 0.0f;
        const Mask surface = sample.active && at.smooth, medium = sample.active && at.in_medium;
        if (dr::any_or<true>(surface)) {
            std::tie(value, pdf) =
                at.bsdf->eval_pdf(BSDFContext(), at.si, at.si.to_local(sample.direction), surface);
        }
        if (dr::any_or<true>(medium)) {
            const auto [phase_value, phase_pdf] = at.phase->eval_pdf(
                PhaseFunctionContext(paths.sampler), at.mei, sample.direction, medium);
            dr::masked(value, medium) = phase_value;
            dr::masked(pdf, medium) = phase_pdf;
        }
        const Float weight = dr::select(sample.delta, 1.0f, mis_weight(sample.pdf, pdf));
        const Spectrum light = paths.throughput * value * sample.weight * weight;
        const Mask traced = sample.active && dr::any(light != 0.0f);
        if (!dr::any_or<true>(traced)) return;
        MediumPtr through = paths.medium;
        const Mask leaves = surface && at.si.is_medium_transition();
        if (dr::any_or<true>(leaves)) {
            dr::masked(through, leaves) = at.si.target_medium(sample.direction);
        }
        const Spectrum arrives =
            shadow_rays_.transmittance(at.point, sample.p, through, paths.sampler, traced);
        dr::masked(paths.result, traced) = paths.result + light * arrives;
    }

    /// Takes the paths on to their next rays, and plays roulette.
    void advance(State& paths, const Vertex& at, const Receiver<Float>& receiver,
                 const Mask& on_surface, const Mask& samples, const Mask& goes_on) const {
        Mask straight = on_surface && hides(paths, at.si);
        const Mask reflects = on_surface && !straight;
        Mask scattered = at.in_medium, smooth = at.in_medium;
        if (dr::any_or<true>(reflects)) {
            const Float random_1 = paths.sampler->next_1d(reflects);
            const Point2f random_2 = paths.sampler->next_2d(reflects);
            const auto [next, weight] =
                at.bsdf->sample(BSDFContext(), at.si, random_1, random_2, reflects);
            const Mask is_null = reflects && has_flag(next.sampled_type, BSDFFlags::Null);
            dr::masked(paths.throughput, reflects) = paths.throughput * weight;
            dr::masked(paths.eta, reflects) = paths.eta * next.eta;
            const Mask turns = reflects && !is_null && goes_on;
            dr::masked(paths.ray.d, turns) = at.si.to_world(next.wo);
            dr::masked(paths.pdf, turns) = next.pdf;
            straight |= is_null;
            paths.valid |= reflects && !is_null;
            scattered |= turns;
            smooth |= turns && !has_flag(next.sampled_type, BSDFFlags::Delta);
        }
        const Mask leaves = scattered && !at.in_medium;
        dr::masked(paths.ray, straight || leaves) = at.si.spawn_ray(paths.ray.d);
        const Mask changes = (straight || leaves) && at.si.is_medium_transition();
        if (dr::any_or<true>(changes)) {
            dr::masked(paths.medium, changes) = at.si.target_medium(paths.ray.d);
        }
        if (dr::any_or<true>(at.in_medium)) {
            const Float random_1 = paths.sampler->next_1d(at.in_medium);
            const Point2f random_2 = paths.sampler->next_2d(at.in_medium);
            const auto [direction, weight, pdf] = at.phase->sample(
                PhaseFunctionContext(paths.sampler), at.mei, random_1, random_2, at.in_medium);
            dr::masked(paths.throughput, at.in_medium) = paths.throughput * weight;
            dr::masked(paths.ray, at.in_medium) = at.mei.spawn_ray(direction);
            dr::masked(paths.pdf, at.in_medium) = pdf;
            scattered &= !at.in_medium || pdf > 0.0f;
        }
        paths.valid |= scattered;
        dr::masked(paths.last, scattered) = at.point;
        dr::masked(paths.receiver, scattered) = receiver;
        dr::masked(paths.weigh, scattered) = samples && smooth;
        dr::masked(paths.depth, scattered) = paths.depth + 1u;
        paths.active = (straight || scattered) && survives(paths, scattered);
    }

    /// Whether the camera is to look through what it sees there.
    Mask hides(const State& paths, const SurfaceInteraction3f& si) const {
        if (!context_.hide_emitters) return false;
        return paths.depth == 0u && si.is_valid() && si.shape->emitter() != nullptr;
    }

    /// Plays roulette for paths that were just scattered.
    Mask survives(State& paths, const Mask& scattered) const {
        const Float largest = dr::max(paths.throughput);
        const Mask plays = scattered && paths.depth > context_.rr_depth;
        Mask survives = largest > 0.0f;
        if (dr::any_or<true>(plays)) {
            const Float survival = dr::minimum(largest * dr::square(paths.eta), 0.95f);
            survives &= !plays || paths.sampler->next_1d(plays) < survival;
            dr::masked(paths.throughput, plays) = paths.throughput * dr::rcp(survival);
        }
        return survives;
    }

    const PathContext<Float, Spectrum>& context_;
    const VolumeLights<Float, Spectrum>& lights_;
    SceneMedia media_;
    ShadowRays<Float, Spectrum> shadow_rays_;
};

}  // namespace

template <typename Float, typename Spectrum>
std::pair<Spectrum, dr::mask_t<Float>> trace_volume(
    const PathContext<Float, Spectrum>& context, const VolumeLights<Float, Spectrum>& lights,
    SceneMedia media, const Medium<Float, Spectrum>* medium, Sampler<Float, Spectrum>* sampler,
    const RayDifferential<Point<Float, 3>, Spectrum>& rays, const dr::mask_t<Float>& active) {
    using State = VolumeState<Float, Spectrum>;
    media.add(medium);
    const VolumeStep<Float, Spectrum> step(context, lights, media);
    State paths = step.start(rays, medium, sampler, active);
    dr::tie(paths) = dr::while_loop(
        dr::make_tuple(paths), [](const State& state) { return state.active; },
        [&step](State& state) { step(state); }, "lightcull: through media");
    return {dr::select(paths.valid, paths.result, 0.0f), paths.valid};
}

#define INSTANTIATE(Float, Spectrum)                                                           \
    template std::pair<Spectrum, dr::mask_t<Float>> trace_volume<Float, Spectrum>(             \
        const PathContext<Float, Spectrum>&, const VolumeLights<Float, Spectrum>&, SceneMedia, \
        const Medium<Float, Spectrum>*, Sampler<Float, Spectrum>*,                             \
        const RayDifferential<Point<Float, 3>, Spectrum>&, const dr::mask_t<Float>&);
LIGHTCULL_VARIANTS(INSTANTIATE)

}  // namespace mitsuba::culling
