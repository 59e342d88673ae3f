#include "wavefront/trace_wavefront.h"

#include "arrays/variants.h"
#include "lanes/lane_lights.h"
#include "paths/mis_weight.h"
#include "scene/surface_receiver.h"
#include "scene/triangle_pdf.h"
#include "wavefront/lane_random.h"
#include "wavefront/path_states.h"

namespace mitsuba::culling {
namespace {

/// A pass of paths, bounce by bounce. A bounce is two kernels: what the rays meet, and what happens
/// there; between them the processor chooses lights. Where there is no choice, it is one kernel.
/// Where light is added, and in depths, roulette and weights, it does what Mitsuba's `path` does.
template <typename Float, typename Spectrum>
class Wavefront {
  public:
    MI_IMPORT_TYPES(Scene, Sampler, Emitter, EmitterPtr, BSDF, BSDFPtr, Shape, ShapePtr)

    using Tables = LightTables<Float, Spectrum>;

    Wavefront(const PathContext<Float, Spectrum>& context, Sampler* sampler,
              const WavefrontPass<Float, Spectrum>& pass)
        : context_(context),
          tables_(pass.tables),
          lights_(pass.tables),
          selector_(*context.light_sampler, context.lights->lights().size(), pass.pattern,
                    pass.memory),
          random_(sampler, pass.seed),
          width_(sampler->wavefront_size()) {}

    std::pair<Spectrum, Mask> trace(const RayDifferential3f& camera_rays) {
        start(camera_rays);
        while (dr::width(paths_.path) != 0 && !context_.integrator->should_stop()) {
            random_.keep(paths_.path, depth_);
            find_hits();
            const bool is_last = depth_ + 1 >= context_.max_depth;
            if (selector_.has_choice()) evaluate_hits(is_last);
            hit_prob_ = selector_.hit_probs(asks_, hit_light_, paths_.origin);
            if (is_last) {
                paths_.result += weighted_emission();
                paths_.valid |= sees_emitter_;
                store();
                break;
            }
            chosen_ = selector_.choose(smooth_, position_, receiver_, paths_.path, select_random_,
                                       depth_);
            shade();
            store();
            compact();
            ++depth_;
        }
        return {dr::select(valid_, result_, 0.0f), valid_};
    }

  private:
    void start(const RayDifferential3f& camera_rays) {
        result_ = dr::zeros<Spectrum>(width_);
        valid_ = dr::full<Mask>(false, width_);
        paths_ = dr::zeros<PathStates<Float, Spectrum>>(width_);
        paths_.path = dr::arange<UInt32>(width_);
        paths_.ray = Ray3f(camera_rays);
        paths_.throughput = dr::full<Spectrum>(1.0f, width_);
        paths_.eta = dr::full<Float>(1.0f, width_);
        paths_.bsdf_pdf = dr::full<Float>(1.0f, width_);
        paths_.valid = dr::full<Mask>(
            !context_.hide_emitters && context_.scene->environment() != nullptr, width_);
        // Later bounces have no literals either, so that they need no other kernel.
        dr::make_opaque(result_, valid_, paths_);
    }

    /// Finds what the rays meet, and all that choosing lights takes.
    void find_hits() {
        const Scene* scene = context_.scene;
        hit_ = scene->ray_intersect_preliminary(paths_.ray, depth_ == 0, false, 0, 0, true);
        if (context_.hide_emitters && depth_ == 0) skip_emitters();
        si_ = hit_.compute_surface_interaction(paths_.ray, +RayFlags::All);
        hits_surface_ = si_.is_valid();
        find_emission();
        const BSDFPtr bsdf = si_.bsdf(paths_.ray);
        const UInt32 flags = bsdf->flags();
        smooth_ = hits_surface_ && has_flag(flags, BSDFFlags::Smooth);
        if (!selector_.has_choice()) return;
        position_ = si_.p;
        receiver_ = context_.has_lobes ? glossy_receiver<Float, Spectrum>(si_, bsdf, flags, smooth_)
                                       : matte_receiver<Float, Spectrum>(si_, flags);
        select_random_ = random_.next_1d();
    }

    /// Runs the first kernel.
    void evaluate_hits(bool is_last) {
        dr::schedule(hit_, emission_, emission_pdf_, hit_light_, asks_, sees_emitter_,
                     hits_surface_);
        if (!is_last) {
            dr::schedule(smooth_, position_, receiver_, select_random_);
            random_.schedule();
        }
        dr::eval();
        dr::sync_thread();
        // The interaction is cheaper to compute again than to keep.
        si_ = hit_.compute_surface_interaction(paths_.ray, +RayFlags::All);
    }

    /// Looks behind the emitters that camera rays hit.
    void skip_emitters() {
        const Mask skip = hit_.is_valid() && hit_.shape->emitter() != nullptr;
        const SurfaceInteraction3f si =
            hit_.compute_surface_interaction(paths_.ray, +RayFlags::Minimal, skip);
        dr::masked(hit_, skip) = context_.integrator->skip_area_emitters(
            context_.scene, si.spawn_ray(paths_.ray.d), true, skip);
    }

    /// Finds the emission of what the rays have hit, or of the environment. It is not weighted yet,
    /// since the probability of the light is not known.
    void find_emission() {
        const EmitterPtr emitter = si_.emitter(context_.scene);
        const Mask there = emitter != nullptr && paths_.bsdf_pdf > 0.0f;
        sees_emitter_ = there && !context_.hide_emitters;
        emission_ = dr::select(there, paths_.throughput * emitter->eval(si_, there), 0.0f);
        const DirectionSample3f ds(context_.scene, si_, paths_.last);
        const Mask weigh = there && paths_.weigh;
        const auto entry = tables_.find(emitter, weigh);
        const Mask triangle = weigh && entry.kind == Tables::kTriangles;
        const Mask whole = weigh && entry.kind == Tables::kWhole;
        const Mask unplaced = weigh && entry.kind == Tables::kUnplaced;
        hit_light_ = entry.first_light + dr::select(triangle, si_.prim_index, 0u);
        asks_ = triangle || whole;
        emission_pdf_ = dr::select(unplaced, entry.prob, 1.0f) *
                        emitter->pdf_direction(paths_.last, ds, whole || unplaced);
        if (tables_.has_triangles()) {
            const auto place = tables_.find_place(hit_light_, hit_.prim_uv, triangle);
            dr::masked(hit_light_, triangle) = place.light;
            dr::masked(emission_pdf_, triangle) = triangle_pdf(place.density, si_.n, ds.d, ds.dist);
        }
        dr::masked(emission_pdf_, !(asks_ || unplaced)) = 0.0f;
    }

    Spectrum weighted_emission() const {
        const Float weight = mis_weight(paths_.bsdf_pdf, hit_prob_ * emission_pdf_);
        return emission_ * dr::select(paths_.weigh, weight, 1.0f);
    }

    /// Runs the second kernel: emission, light from the chosen lights, and the next rays.
    void shade() {
        paths_.result += weighted_emission();
        paths_.valid |= sees_emitter_ && !hits_surface_;
        const BSDFPtr bsdf = si_.bsdf(paths_.ray);
        const BSDFContext context;
        if (tables_.has_unplaced()) {
            const Float random = random_.next_1d();
            const auto sample = lights_.sample_unplaced(si_, random, random_.next_2d(), smooth_);
            const auto [value, pdf] =
                bsdf->eval_pdf(context, si_, si_.to_local(sample.direction), sample.active);
            add_if_visible(sample, value, pdf);
        }
        auto sample = dr::zeros<LightSample<Float, Spectrum>>();
        if (!context_.lights->lights().empty()) {
            sample = lights_.sample_chosen(si_, chosen_, lights_.draw_random(random_), smooth_);
            if (context_.vertex_culling) cull_at_vertices(sample);
        }
        const Float random_1 = random_.next_1d();
        const Point2f random_2 = random_.next_2d();
        const auto [value, pdf, next, weight] = bsdf->eval_pdf_sample(
            context, si_, si_.to_local(sample.direction), random_1, random_2, hits_surface_);
        const ShadowRays shadow_rays = add_if_visible(sample, value, pdf);
        advance(next, weight);
        const bool reports = selector_.wants_reports();
        dr::schedule(paths_, going_on_);
        if (reports) dr::schedule(shadow_rays.traced, shadow_rays.arrived);
        random_.schedule();
        dr::eval();
        if (reports) selector_.report(shadow_rays.traced, shadow_rays.arrived);
    }

    /// Has the processor decide about the places on the lights, between two kernels.
    void cull_at_vertices(LightSample<Float, Spectrum>& sample) {
        dr::eval(sample);
        const Float prob =
            selector_.vertex_probs(*context_.vertex_culling, sample.active, sample.p);
        sample.active &= prob > 0.0f;
        sample.weight = dr::select(sample.active, sample.weight / prob, 0.0f);
    }

    /// The lanes that traced a shadow ray, and those in which it arrived.
    struct ShadowRays {
        Mask traced, arrived;
    };

    ShadowRays add_if_visible(const LightSample<Float, Spectrum>& sample,
                              const Spectrum& bsdf_value, const Float& bsdf_pdf) {
        const Spectrum light = paths_.throughput * bsdf_value * sample.weight *
                               dr::select(sample.delta, 1.0f, mis_weight(sample.pdf, bsdf_pdf));
        const Mask traced = sample.active && smooth_ && dr::any(light != 0.0f);
        const Mask arrived =
            traced && !context_.scene->ray_test(si_.spawn_ray_to(sample.p), traced);
        dr::masked(paths_.result, arrived) += light;
        return {traced, arrived};
    }

    /// Moves the paths on to their next rays, and plays roulette.
    void advance(const BSDFSample3f& next, const Spectrum& weight) {
        paths_.ray = si_.spawn_ray(si_.to_world(next.wo));
        paths_.throughput *= weight;
        paths_.eta *= next.eta;
        paths_.valid |= hits_surface_ && !has_flag(next.sampled_type, BSDFFlags::Null);
        paths_.last = Interaction3f(si_);
        paths_.bsdf_pdf = next.pdf;
        paths_.weigh = smooth_ && !has_flag(next.sampled_type, BSDFFlags::Delta);

        const Float largest = dr::max(paths_.throughput);
        going_on_ = hits_surface_ && largest > 0.0f;
        const Float random = random_.next_1d();
        if (depth_ + 1 < context_.rr_depth) return;
        const Float survival = dr::minimum(largest * dr::square(paths_.eta), 0.95f);
        going_on_ &= random < survival;
        paths_.throughput *= dr::rcp(survival);
    }

    /// Stores what the paths have brought, in the order of the whole wavefront.
    void store() {
        dr::scatter(result_, paths_.result, paths_.path);
        dr::scatter(valid_, paths_.valid, paths_.path);
    }

    /// Drops the paths that have ended.
    void compact() {
        const UInt32 left = dr::compress(going_on_);
        paths_ = dr::gather<PathStates<Float, Spectrum>>(paths_, left);
        paths_.origin = left;
        dr::eval(paths_, result_, valid_);
    }

    const PathContext<Float, Spectrum>& context_;
    const Tables& tables_;
    LaneLights<Float, Spectrum> lights_;
    LaneSelector selector_;
    LaneRandom<Float, Spectrum> random_;
    std::uint32_t width_;
    std::uint32_t depth_ = 0;
    Spectrum result_;
    Mask valid_;
    PathStates<Float, Spectrum> paths_;
    // These are of the bounce under way.
    PreliminaryIntersection3f hit_;
    SurfaceInteraction3f si_;
    Mask hits_surface_, smooth_, sees_emitter_, asks_, going_on_;
    Point3f position_;
    Receiver<Float> receiver_;
    Float select_random_;
    Spectrum emission_;
    Float emission_pdf_, hit_prob_;
    UInt32 hit_light_;
    LaneSelector::Chosen chosen_;
};

}  // namespace

template <typename Float, typename Spectrum>
std::pair<Spectrum, dr::mask_t<Float>> trace_wavefront(
    const PathContext<Float, Spectrum>& context, Sampler<Float, Spectrum>* sampler,
    const RayDifferential<Point<Float, 3>, Spectrum>& rays,
    const WavefrontPass<Float, Spectrum>& pass) {
    const dr::suspend_grad<Float> no_derivatives;
    return Wavefront<Float, Spectrum>(context, sampler, pass).trace(rays);
}

// NOLINTBEGIN(bugprone-macro-parentheses)
#define INSTANTIATE(Float, Spectrum)                                                  \
    template std::pair<Spectrum, dr::mask_t<Float>> trace_wavefront<Float, Spectrum>( \
        const PathContext<Float, Spectrum>&, Sampler<Float, Spectrum>*,               \
        const RayDifferential<Point<Float, 3>, Spectrum>&, const WavefrontPass<Float, Spectrum>&);
LIGHTCULL_LLVM_VARIANTS(INSTANTIATE)
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace mitsuba::culling
