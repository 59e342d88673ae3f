#include "loop/trace_loop.h"

#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/sampler.h>

#include "arrays/variants.h"
#include "loop/kernel_lights.h"
#include "paths/mis_weight.h"
#include "scene/surface_receiver.h"

namespace mitsuba::culling {
namespace {

/// The state of the paths, which the loop carries from bounce to bounce.
template <typename Float_, typename Spectrum_>
struct LoopState {
    using Float = Float_;
    using Spectrum = Spectrum_;
    MI_IMPORT_TYPES(Sampler)

    Ray3f ray;
    Spectrum throughput, result;
    Float eta;
    UInt32 depth;
    Mask valid;
    // The last vertex, for the weight of what its ray hits.
    Interaction3f last;
    Receiver<Float> receiver;
    Float bsdf_pdf;
    Mask weigh;
    Mask active;
    Sampler* sampler;

    // NOLINTNEXTLINE(performance-noexcept-move-constructor)
    DRJIT_STRUCT(LoopState, ray, throughput, result, eta, depth, valid, last, receiver, bsdf_pdf,
                 weigh, active, sampler)
};

/// A bounce of all paths. Where light is added, and in depths, roulette and weights, it does what
/// Mitsuba's `path` does.
template <typename Float, typename Spectrum>
class Bounce {
  public:
    MI_IMPORT_TYPES(Scene, Sampler, Emitter, EmitterPtr, BSDF, BSDFPtr, Shape, ShapePtr)

    using State = LoopState<Float, Spectrum>;
    using Sample = LightSample<Float, Spectrum>;

    /// `derives`: operator() is called with `derived`.
    Bounce(const PathContext<Float, Spectrum>& context, const LightTables<Float, Spectrum>& tables,
           const LightBvhArrays<Float>& bvh, bool derives = false)
        : context_(context), lights_(context, tables, bvh, derives) {}

    State start(const RayDifferential3f& rays, Sampler* sampler, const Mask& active) const {
        const Mask valid = !context_.hide_emitters && context_.scene->environment() != nullptr;
        return {Ray3f(rays),
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
    }

    /// Adds the light that the paths find to their results. With `derived`, which is 0 before, it
    /// does this again for paths whose results are what is found from here on: it takes the light
    /// off them, so that only that of later bounces is left, and `derived` is all of it, with
    /// derivatives ([Vicini et al. 2021], path replay).
    void operator()(State& paths, Spectrum* derived = nullptr) const {
        PreliminaryIntersection3f hit = find_hits(paths);
        SurfaceInteraction3f si =
            hit.compute_surface_interaction(paths.ray, +RayFlags::All, paths.active);
        const Mask sees_emitter = add_emission(paths, si, hit.prim_uv, derived);
        const Mask goes_on = paths.active && paths.depth + 1u < context_.max_depth && si.is_valid();
        if (!context_.hide_emitters) paths.valid |= paths.active && !goes_on && sees_emitter;
        shade(paths, si, goes_on, derived);
        paths.depth += 1u;
    }

  private:
    PreliminaryIntersection3f find_hits(const State& paths) const {
        const Mask is_first = paths.depth == 0u;
        PreliminaryIntersection3f hit = context_.scene->ray_intersect_preliminary(
            paths.ray, is_first, false, 0, 0, paths.active);
        if (context_.hide_emitters) {
            const Mask skip =
                paths.active && is_first && hit.is_valid() && hit.shape->emitter() != nullptr;
            const SurfaceInteraction3f si =
                hit.compute_surface_interaction(paths.ray, +RayFlags::Minimal, skip);
            dr::masked(hit, skip) = context_.integrator->skip_area_emitters(
                context_.scene, si.spawn_ray(paths.ray.d), true, skip);
        }
        return hit;
    }

    /// Adds the light of what the rays have hit, or of the environment; says where there was any.
    Mask add_emission(State& paths, const SurfaceInteraction3f& si, const Point2f& prim_uv,
                      Spectrum* derived) const {
        const EmitterPtr emitter = si.emitter(context_.scene, paths.active);
        const Mask is_there = emitter != nullptr;
        const Mask shines = paths.active && is_there && paths.bsdf_pdf > 0.0f;
        const auto place_of = [&](const UInt32&, const Mask&) { return prim_uv; };
        const Float light_pdf =
            lights_.pdf(paths.last, paths.receiver, si, emitter, place_of, shines && paths.weigh);
        const Float weight = dr::select(paths.weigh, mis_weight(paths.bsdf_pdf, light_pdf), 1.0f);
        const dr::resume_grad<Float> derivatives(derived != nullptr);
        add(paths, shines, paths.throughput * emitter->eval(si, shines) * weight, derived);
        return is_there;
    }

    /// Adds light to the results, or takes it off and adds it to `derived`.
    static void add(State& paths, const Mask& where, const Spectrum& light, Spectrum* derived) {
        if (derived) {
            *derived += dr::select(where, light, 0.0f);
            dr::masked(paths.result, where) = paths.result - dr::detach(light);
        } else {
            dr::masked(paths.result, where) = paths.result + light;
        }
    }

    /// Adds direct light, and scatters the paths.
    void shade(State& paths, SurfaceInteraction3f& si, const Mask& active,
               Spectrum* derived) const {
        const BSDFPtr bsdf = si.bsdf(paths.ray);
        const BSDFContext context;
        const UInt32 flags = bsdf->flags();
        const Mask smooth = active && has_flag(flags, BSDFFlags::Smooth);
        if (lights_.has_choice()) {
            paths.receiver = context_.has_lobes
                                 ? glossy_receiver<Float, Spectrum>(si, bsdf, flags, smooth)
                                 : matte_receiver<Float, Spectrum>(si, flags);
        }
        if (lights_.has_lights() && lights_.has_unplaced()) {
            const Sample sample = lights_.sample_unplaced(si, paths.sampler, smooth, true);
            const auto [value, pdf] =
                bsdf->eval_pdf(context, si, si.to_local(sample.direction), sample.active);
            add_if_visible(paths, si, bsdf, sample, value, pdf, derived);
        }
        Sample sample = dr::zeros<Sample>();
        if (lights_.has_lights()) {
            sample = lights_.sample_light(si, paths.receiver, paths.sampler, smooth, true);
        } else if (lights_.has_unplaced()) {
            sample = lights_.sample_unplaced(si, paths.sampler, smooth, true);
        }
        const Float random_1 = paths.sampler->next_1d();
        const Point2f random_2 = paths.sampler->next_2d();
        const auto [value, pdf, next, weight] = bsdf->eval_pdf_sample(
            context, si, si.to_local(sample.direction), random_1, random_2, active);
        add_if_visible(paths, si, bsdf, sample, value, pdf, derived);
        advance(paths, si, next, weight, smooth, active);
        if (!derived) return;
        const dr::resume_grad<Float> derivatives;
        const Spectrum scattered = bsdf->eval(context, si, next.wo, active);
        const Spectrum value_now = dr::detach(scattered);
        const Spectrum later = dr::select(value_now != 0.0f, paths.result / value_now, 0.0f);
        *derived += later * scattered;
    }

    void add_if_visible(State& paths, const SurfaceInteraction3f& si, const BSDFPtr& bsdf,
                        const Sample& sample, Spectrum bsdf_value, const Float& bsdf_pdf,
                        Spectrum* derived) const {
        const dr::resume_grad<Float> derivatives(derived != nullptr);
        if (derived) {
            bsdf_value =
                bsdf->eval(BSDFContext(), si, si.to_local(sample.direction), sample.active);
        }
        const Spectrum light = paths.throughput * bsdf_value * sample.weight *
                               dr::select(sample.delta, 1.0f, mis_weight(sample.pdf, bsdf_pdf));
        const Mask traced = sample.active && dr::any(light != 0.0f);
        const Mask arrived = traced && !context_.scene->ray_test(si.spawn_ray_to(sample.p), traced);
        add(paths, arrived, light, derived);
    }

    /// Moves the paths on to their next rays, and plays roulette.
    void advance(State& paths, const SurfaceInteraction3f& si, const BSDFSample3f& next,
                 const Spectrum& weight, const Mask& smooth, const Mask& active) const {
        paths.ray = si.spawn_ray(si.to_world(next.wo));
        paths.throughput *= weight;
        paths.eta *= next.eta;
        paths.valid |= active && !has_flag(next.sampled_type, BSDFFlags::Null);
        paths.last = Interaction3f(si);
        paths.bsdf_pdf = next.pdf;
        paths.weigh = smooth && !has_flag(next.sampled_type, BSDFFlags::Delta);

        const Float largest = dr::max(paths.throughput);
        const Float survival = dr::minimum(largest * dr::square(paths.eta), 0.95f);
        const Mask plays = paths.depth + 1u >= context_.rr_depth;
        const Mask survives = paths.sampler->next_1d() < survival;
        dr::masked(paths.throughput, plays) = paths.throughput * dr::rcp(survival);
        paths.active = active && largest > 0.0f && (!plays || survives);
    }

    const PathContext<Float, Spectrum>& context_;
    KernelLights<Float, Spectrum> lights_;
};

}  // namespace

template <typename Float, typename Spectrum>
std::pair<Spectrum, dr::mask_t<Float>> trace_loop(
    const PathContext<Float, Spectrum>& context, Sampler<Float, Spectrum>* sampler,
    const RayDifferential<Point<Float, 3>, Spectrum>& rays,
    const LightTables<Float, Spectrum>& tables, const LightBvhArrays<Float>& bvh,
    const dr::mask_t<Float>& active) {
    using State = LoopState<Float, Spectrum>;
    const dr::suspend_grad<Float> no_derivatives;
    const Bounce<Float, Spectrum> bounce(context, tables, bvh);
    State paths = bounce.start(rays, sampler, active);
    dr::tie(paths) = dr::while_loop(
        dr::make_tuple(paths), [](const State& state) { return state.active; },
        [&bounce](State& state) { bounce(state); }, "lightcull: bounces");
    return {dr::select(paths.valid, paths.result, 0.0f), paths.valid};
}

template <typename Float, typename Spectrum>
Spectrum derive_loop(const PathContext<Float, Spectrum>& context, Sampler<Float, Spectrum>* sampler,
                     const RayDifferential<Point<Float, 3>, Spectrum>& rays,
                     const LightTables<Float, Spectrum>& tables, const LightBvhArrays<Float>& bvh,
                     const dr::mask_t<Float>& active, dr::ADMode mode, const Spectrum& change) {
    using State = LoopState<Float, Spectrum>;
    const dr::suspend_grad<Float> no_derivatives;
    ref<Sampler<Float, Spectrum>> same_numbers = sampler->clone();
    const auto [light, valid] = trace_loop(context, sampler, rays, tables, bvh, active);
    const Bounce<Float, Spectrum> bounce(context, tables, bvh, true);
    State paths = bounce.start(rays, same_numbers.get(), active);
    paths.result = light;
    bool is_derived = false;
    Spectrum changes = dr::select(valid, change, 0.0f);
    dr::tie(paths, changes) = dr::while_loop(
        dr::make_tuple(paths, changes),
        [](const State& state, const Spectrum&) { return state.active; },
        [&](State& state, Spectrum& change) {
            Spectrum derived(0.0f);
            bounce(state, &derived);
            const dr::resume_grad<Float> derivatives;
            if (!dr::grad_enabled(derived)) return;
            is_derived = true;
            if (mode == dr::ADMode::Backward) {
                Spectrum weighted = change * derived;
                dr::backward_from(weighted);
            } else {
                // Later bounces, and passes, need the derivatives of the parameters, too.
                dr::forward_to(derived, dr::ADFlag::ClearEdges | dr::ADFlag::ClearInterior);
                change += dr::grad(derived);
            }
        },
        "lightcull: bounces, with derivatives");
    if (!is_derived) {
        Throw(
            "lightcull_path has derivatives by emission, materials and textures, and none by "
            "what was asked for");
    }
    return dr::select(valid, changes, 0.0f);
}

// NOLINTBEGIN(bugprone-macro-parentheses)
#define INSTANTIATE(Float, Spectrum)                                                            \
    template Spectrum derive_loop<Float, Spectrum>(                                             \
        const PathContext<Float, Spectrum>&, Sampler<Float, Spectrum>*,                         \
        const RayDifferential<Point<Float, 3>, Spectrum>&, const LightTables<Float, Spectrum>&, \
        const LightBvhArrays<Float>&, const dr::mask_t<Float>&, dr::ADMode, const Spectrum&);   \
    template std::pair<Spectrum, dr::mask_t<Float>> trace_loop<Float, Spectrum>(                \
        const PathContext<Float, Spectrum>&, Sampler<Float, Spectrum>*,                         \
        const RayDifferential<Point<Float, 3>, Spectrum>&, const LightTables<Float, Spectrum>&, \
        const LightBvhArrays<Float>&, const dr::mask_t<Float>&);
LIGHTCULL_LLVM_VARIANTS(INSTANTIATE)
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace mitsuba::culling
