#include "scalar/trace_path.h"

#include <lightcull/samplers.h>

#include <optional>

#include "arrays/variants.h"
#include "paths/mis_weight.h"
#include "scalar/light_samples.h"

namespace mitsuba::culling {
namespace {

using ::lightcull::LightOutcome;
using ::lightcull::Selection;
using ::lightcull::ShadingPoint;

/// One path, from the camera to its end. Where light is added, and in depths, roulette and weights,
/// it does what Mitsuba's `path` does.
template <typename Float, typename Spectrum>
class ScalarPath {
  public:
    MI_IMPORT_TYPES(Scene, Sampler, Emitter, BSDF)

    ScalarPath(const PathContext<Float, Spectrum>& context, Sampler* sampler, const PathSets& sets)
        : context_(context), samples_(context), sampler_(sampler), sets_(sets) {}

    std::pair<Spectrum, bool> trace(const RayDifferential3f& camera_ray) {
        ray_ = Ray3f(camera_ray);
        valid_ = !context_.hide_emitters && context_.scene->environment() != nullptr;
        PreliminaryIntersection3f hit =
            context_.scene->ray_intersect_preliminary(ray_, true, false, 0, 0, true);
        if (context_.hide_emitters) hit = behind_emitters(hit);
        while (true) {
            si_ = hit.compute_surface_interaction(ray_, +RayFlags::All);
            add_emission(hit.prim_uv);
            if (depth_ + 1 >= context_.max_depth || !si_.is_valid()) {
                valid_ |= si_.emitter(context_.scene) != nullptr && !context_.hide_emitters;
                break;
            }
            if (!shade(camera_ray)) break;
            hit = context_.scene->ray_intersect_preliminary(ray_, false, false, 0, 0, true);
        }
        return {valid_ ? result_ : Spectrum(0.0f), valid_};
    }

  private:
    /// Whether a shadow ray arrived; none if none was traced.
    using Arrival = std::optional<bool>;

    /// What a ray hits if the emitters in front of it are not there.
    PreliminaryIntersection3f behind_emitters(PreliminaryIntersection3f hit) const {
        if (!hit.is_valid() || !hit.shape->is_emitter()) return hit;
        const SurfaceInteraction3f si = hit.compute_surface_interaction(ray_, +RayFlags::Minimal);
        return context_.integrator->skip_area_emitters(context_.scene, si.spawn_ray(ray_.d), true);
    }

    /// Adds the light of what the ray has hit, or of the environment.
    void add_emission(const Point2f& prim_uv) {
        const Emitter* emitter = si_.emitter(context_.scene);
        if (!emitter || !(bsdf_pdf_ > 0.0f)) return;
        const Spectrum radiance = emitter->eval(si_);
        const Float weight =
            weigh_ ? mis_weight(bsdf_pdf_, light_pdf(emitter, prim_uv)) : Float(1.0f);
        result_ += throughput_ * radiance * weight;
    }

    /// The density with which the last vertex would have sampled what was hit as a light.
    Float light_pdf(const Emitter* emitter, const Point2f& prim_uv) const {
        return samples_.pdf(
            last_, si_, emitter, [&](std::uint32_t) { return prim_uv; },
            [this](std::uint32_t light) { return prob(light); });
    }

    /// Adds direct light at si_, and scatters the path; false if it ends here.
    bool shade(const RayDifferential3f& camera_ray) {
        const BSDF* bsdf = si_.bsdf(depth_ == 0 ? camera_ray : RayDifferential3f(ray_));
        const std::uint32_t flags = bsdf->flags();
        const bool smooth = has_flag(flags, BSDFFlags::Smooth);
        if (smooth) {
            select_light(bsdf, flags);
            add_light(bsdf);
            add_unplaced(bsdf);
        }
        const auto [sample, weight] =
            bsdf->sample(BSDFContext(), si_, sampler_->next_1d(), sampler_->next_2d());
        ray_ = si_.spawn_ray(si_.to_world(sample.wo));
        throughput_ *= weight;
        eta_ *= sample.eta;
        valid_ |= !has_flag(sample.sampled_type, BSDFFlags::Null);
        last_ = Interaction3f(si_);
        bsdf_pdf_ = sample.pdf;
        weigh_ = smooth && !has_flag(sample.sampled_type, BSDFFlags::Delta);
        ++depth_;
        return survives();
    }

    void select_light(const BSDF* bsdf, std::uint32_t bsdf_flags) {
        const auto& lights = context_.lights->lights();
        if (lights.size() < 2) {
            const float certain = lights.empty() ? 0.0f : 1.0f;
            selection_ = {0, certain, certain, {}};
            return;
        }
        const bool glossy = has_flag(bsdf_flags, BSDFFlags::GlossyReflection);
        const Receiver<Float> receiver =
            glossy ? glossy_receiver<Float, Spectrum>(si_, bsdf, bsdf_flags, true)
                   : matte_receiver<Float, Spectrum>(si_, bsdf_flags);
        point_ =
            shading_point(si_.p, receiver, sets_.at(depth_, context_.light_sampler->set_count()));
        selection_ = context_.light_sampler->select(point_, sampler_->next_1d());
    }

    /// The probability of `light` at the last vertex, for weights.
    Float prob(std::uint32_t light) const {
        if (context_.lights->lights().size() < 2) return 1.0f;
        return context_.light_sampler->prob(point_, selection_.receipt, light);
    }

    /// Adds light from the light that was selected, and reports whether any arrived.
    void add_light(const BSDF* bsdf) {
        if (!(selection_.prob > 0.0f)) return;
        const auto select_prob = [this](const Point3f& p) {
            return selection_.prob * vertex_prob(p);
        };
        const Arrival arrival = add_if_visible(
            bsdf,
            samples_.of_light(si_, selection_.light, sampler_, select_prob, selection_.mis_prob));
        if (arrival) report(*arrival);
    }

    void report(bool arrived) const {
        if (context_.lights->lights().size() < 2 || !context_.light_sampler->wants_reports()) {
            return;
        }
        const LightOutcome outcome{point_.position, point_.normal, selection_.receipt,
                                   selection_.light, arrived ? 1.0f : 0.0f};
        context_.light_sampler->report({&outcome, 1});
    }

    /// The part of the selected light's probability that depends on the place on it.
    Float vertex_prob(const Point3f& p) const {
        if (!context_.vertex_culling) return 1.0f;
        return context_.vertex_culling->vertex_prob(point_, selection_.receipt, selection_.light,
                                                    to_float3(p));
    }

    /// Adds light from one of the emitters without a place.
    void add_unplaced(const BSDF* bsdf) {
        if (context_.lights->unplaced().empty()) return;
        add_if_visible(bsdf, samples_.of_unplaced(si_, sampler_));
    }

    /// Adds the light of a sample if nothing hides it.
    Arrival add_if_visible(const BSDF* bsdf, const LightSample<Float, Spectrum>& sample) {
        if (!sample.active) return {};
        const Vector3f wo = si_.to_local(sample.direction);
        const auto [value, bsdf_pdf] = bsdf->eval_pdf(BSDFContext(), si_, wo);
        if (dr::all(unpolarized_spectrum(value) == 0.0f)) return {};
        if (context_.scene->ray_test(si_.spawn_ray_to(sample.p))) return false;
        const Float mis = sample.delta ? Float(1.0f) : mis_weight(sample.pdf, bsdf_pdf);
        result_ += throughput_ * value * sample.weight * mis;
        return true;
    }

    /// Plays roulette; false if the path ends here.
    bool survives() {
        const Float largest = dr::max(unpolarized_spectrum(throughput_));
        if (!(largest > 0.0f)) return false;
        if (depth_ < context_.rr_depth) return true;
        const Float survival = dr::minimum(largest * dr::square(eta_), 0.95f);
        if (sampler_->next_1d() >= survival) return false;
        throughput_ *= dr::rcp(survival);
        return true;
    }

    const PathContext<Float, Spectrum>& context_;
    LightSamples<Float, Spectrum> samples_;
    Sampler* sampler_;
    PathSets sets_;
    Ray3f ray_;
    SurfaceInteraction3f si_;
    Spectrum throughput_{1.0f}, result_{0.0f};
    Float eta_ = 1.0f;
    std::uint32_t depth_ = 0;
    bool valid_ = false;
    // The last vertex, for the weight of what its ray hits.
    Interaction3f last_ = dr::zeros<Interaction3f>();
    Float bsdf_pdf_ = 1.0f;
    bool weigh_ = false;
    // The last vertex as the light sampler knows it, and what it selected there.
    ShadingPoint point_;
    Selection selection_;
};

}  // namespace

template <typename Float, typename Spectrum>
std::pair<Spectrum, bool> trace_path(const PathContext<Float, Spectrum>& context,
                                     Sampler<Float, Spectrum>* sampler,
                                     const RayDifferential<Point<Float, 3>, Spectrum>& ray,
                                     const PathSets& sets) {
    return ScalarPath<Float, Spectrum>(context, sampler, sets).trace(ray);
}

#define INSTANTIATE(Float, Spectrum)                                    \
    template std::pair<Spectrum, bool> trace_path<Float, Spectrum>(     \
        const PathContext<Float, Spectrum>&, Sampler<Float, Spectrum>*, \
        const RayDifferential<Point<Float, 3>, Spectrum>&, const PathSets&);
LIGHTCULL_SCALAR_VARIANTS(INSTANTIATE)

}  // namespace mitsuba::culling
