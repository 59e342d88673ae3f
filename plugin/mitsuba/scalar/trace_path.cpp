#include "scalar/trace_path.h"

#include <lightcull/samplers.h>

#include <mitsuba/core/warp.h>

#include <cmath>
#include <optional>

#include "arrays/variants.h"
#include "paths/draw_place.h"
#include "paths/mis_weight.h"
#include "scene/surface_receiver.h"
#include "scene/triangle_pdf.h"
#include "scene/triangle_point.h"

namespace mitsuba::culling {
namespace {

using ::lightcull::LightOutcome;
using ::lightcull::Selection;
using ::lightcull::ShadingPoint;

template <typename Vector>
::lightcull::float3 to_float3(const Vector& v) {
    return {v.x(), v.y(), v.z()};
}

/// One path, from the camera to its end. Where light is added, and in depths, roulette and weights,
/// it does what Mitsuba's `path` does.
template <typename Float, typename Spectrum>
class ScalarPath {
  public:
    MI_IMPORT_TYPES(Scene, Sampler, Emitter, BSDF)

    ScalarPath(const PathContext<Float, Spectrum>& context, Sampler* sampler, const PathSets& sets)
        : context_(context), sampler_(sampler), sets_(sets) {}

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
        const DirectionSample3f ds(context_.scene, si_, last_);
        const auto* source = context_.lights->find(emitter);
        if (!source) {
            const Float prob = context_.lights->unplaced_prob(emitter);
            return prob > 0.0f ? prob * emitter->pdf_direction(last_, ds) : 0.0f;
        }
        if (!source->mesh) return prob(source->first) * emitter->pdf_direction(last_, ds);
        const auto [light, density] = context_.lights->places().find(source->first + si_.prim_index,
                                                                     {prim_uv.x(), prim_uv.y()});
        return prob(light) * triangle_pdf(density, si_.n, ds.d, ds.dist);
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
        point_ = {to_float3(si_.p),
                  to_float3(receiver.normal),
                  sets_.at(depth_, context_.light_sampler->set_count()),
                  receiver.diffuse,
                  {to_float3(receiver.axis), receiver.alpha, receiver.peak}};
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
        const auto& source = context_.lights->source_of(selection_.light);
        const Float mis_prob = selection_.mis_prob;
        const auto select_prob = [this](const Point3f& p) {
            return selection_.prob * vertex_prob(p);
        };
        const Arrival arrival = source.mesh
                                    ? add_triangle(bsdf, source, mis_prob)
                                    : add_whole(bsdf, source.emitter, select_prob, mis_prob);
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

    /// Adds light from a point on the triangle that was chosen.
    Arrival add_triangle(const BSDF* bsdf,
                         const typename SceneLights<Float, Spectrum>::Source& source,
                         Float mis_prob) {
        const auto& [index, corners] = context_.lights->triangles()[selection_.light];
        const auto& [a, b, c] = corners;
        const auto [place, density] =
            draw_place(context_.lights->places(), selection_.light, sampler_);
        const Point2f uv(place.x, place.y);
        const Point3f p0(a.x, a.y, a.z), p1(b.x, b.y, b.z), p2(c.x, c.y, c.z);
        const Point3f p = p0 * (1.0f - uv.x() - uv.y()) + p1 * uv.x() + p2 * uv.y();
        const Vector3f way = p - si_.p;
        const Float distance = dr::norm(way);
        if (!(distance > 0.0f)) return {};
        const Vector3f direction = way / distance;
        SurfaceInteraction3f at = triangle_point<Float, Spectrum>(source.mesh, index, uv);
        at.wi = at.to_local(-direction);
        at.wavelengths = ray_.wavelengths;
        at.time = ray_.time;
        const Spectrum radiance = source.emitter->eval(at);
        const Float pdf = triangle_pdf(density, at.n, direction, distance);
        if (!std::isfinite(pdf) || dr::all(unpolarized_spectrum(radiance) == 0.0f)) return {};
        const Float select_prob = selection_.prob * vertex_prob(p);
        if (!(select_prob > 0.0f)) return {};
        const Spectrum weight = radiance / (select_prob * pdf);
        return add_if_visible(bsdf, p, direction, weight, mis_prob * pdf, false);
    }

    /// The part of the selected light's probability that depends on the place on it.
    Float vertex_prob(const Point3f& p) const {
        if (!context_.vertex_culling) return 1.0f;
        return context_.vertex_culling->vertex_prob(point_, selection_.receipt, selection_.light,
                                                    to_float3(p));
    }

    /// Adds light from an emitter that Mitsuba samples. select_prob(p): with what probability it is
    /// selected, if p is sampled on it.
    template <typename SelectProb>
    Arrival add_whole(const BSDF* bsdf, const Emitter* emitter, const SelectProb& select_prob,
                      Float mis_prob) {
        const auto [ds, weight] = emitter->sample_direction(si_, sampler_->next_2d());
        if (!(ds.pdf > 0.0f)) return {};
        const Float prob = select_prob(ds.p);
        if (!(prob > 0.0f)) return {};
        return add_if_visible(bsdf, ds.p, ds.d, weight / prob, mis_prob * ds.pdf, ds.delta);
    }

    /// Adds light from one of the emitters without a place.
    void add_unplaced(const BSDF* bsdf) {
        const auto& unplaced = context_.lights->unplaced();
        if (unplaced.empty()) return;
        std::size_t chosen = 0;
        if (unplaced.size() > 1) {
            Float u = sampler_->next_1d();
            while (chosen + 1 < unplaced.size() && u >= unplaced[chosen].prob) {
                u -= unplaced[chosen++].prob;
            }
        }
        const auto& unplaced_emitter = unplaced[chosen];
        const Float prob = unplaced_emitter.prob;
        add_whole(
            bsdf, unplaced_emitter.emitter, [prob](const Point3f&) { return prob; }, prob);
    }

    /// Adds light from a sample if nothing hides it: `weight` is its radiance divided by its
    /// density, `pdf` the density that stands for it in weights.
    Arrival add_if_visible(const BSDF* bsdf, const Point3f& p, const Vector3f& direction,
                           const Spectrum& weight, Float pdf, bool is_delta) {
        const Vector3f wo = si_.to_local(direction);
        const auto [value, bsdf_pdf] = bsdf->eval_pdf(BSDFContext(), si_, wo);
        if (dr::all(unpolarized_spectrum(value) == 0.0f)) return {};
        if (context_.scene->ray_test(si_.spawn_ray_to(p))) return false;
        const Float mis = is_delta ? Float(1.0f) : mis_weight(pdf, bsdf_pdf);
        result_ += throughput_ * value * weight * mis;
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
