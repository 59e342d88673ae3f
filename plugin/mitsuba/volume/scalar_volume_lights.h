#pragma once

#include <mitsuba/core/warp.h>
#include <mitsuba/render/sampler.h>

#include "paths/draw_place.h"
#include "paths/path_context.h"
#include "scene/light_sample.h"
#include "scene/surface_receiver.h"
#include "scene/triangle_pdf.h"
#include "scene/triangle_point.h"

namespace mitsuba::culling {

/// Chooses and samples lights in scalar variants: the twin of LaneVolumeLights.
template <typename Float, typename Spectrum>
class ScalarVolumeLights {
  public:
    MI_IMPORT_TYPES(Scene, Sampler, Emitter, EmitterPtr)

    using Sample = LightSample<Float, Spectrum>;

    explicit ScalarVolumeLights(const PathContext<Float, Spectrum>& context) : context_(context) {}

    bool has_lights() const { return !context_.lights->lights().empty(); }
    bool has_unplaced() const { return !context_.lights->unplaced().empty(); }

    /// Chooses a light for a point, and samples it. There must be one.
    Sample sample_light(const Interaction3f& point, const Receiver<Float>& receiver,
                        Sampler* sampler, bool active) const {
        auto sample = dr::zeros<Sample>();
        if (!active) return sample;
        std::uint32_t light = 0;
        Float prob = 1.0f, mis_prob = 1.0f;
        if (has_choice()) {
            const auto chosen = context_.light_sampler->select(shading_point(point.p, receiver),
                                                               sampler->next_1d());
            light = chosen.light;
            prob = chosen.prob;
            mis_prob = chosen.mis_prob;
        }
        if (!(prob > 0.0f)) return sample;
        const auto& source = context_.lights->source_of(light);
        return source.mesh
                   ? sample_triangle(point, source, light, sampler, prob, mis_prob)
                   : sample_whole(point, source.emitter, sampler->next_2d(), prob, mis_prob);
    }

    /// Samples one of the emitters without a place. There must be one.
    Sample sample_unplaced(const Interaction3f& point, Sampler* sampler, bool active) const {
        if (!active) return dr::zeros<Sample>();
        const auto& unplaced = context_.lights->unplaced();
        std::size_t chosen = 0;
        if (unplaced.size() > 1) {
            Float u = sampler->next_1d();
            while (chosen + 1 < unplaced.size() && u >= unplaced[chosen].prob) {
                u -= unplaced[chosen++].prob;
            }
        }
        const auto& [emitter, prob] = unplaced[chosen];
        return sample_whole(point, emitter, sampler->next_2d(), prob, prob);
    }

    /// The density with which `hit`, of `emitter`, is sampled as a light from `point`.
    Float pdf(const Interaction3f& point, const Receiver<Float>& receiver,
              const SurfaceInteraction3f& hit, const Emitter* emitter, bool active) const {
        if (!active) return 0.0f;
        const DirectionSample3f ds(context_.scene, hit, point);
        const auto* source = context_.lights->find(emitter);
        if (!source) {
            const Float prob = context_.lights->unplaced_prob(emitter);
            return prob > 0.0f ? prob * emitter->pdf_direction(point, ds) : 0.0f;
        }
        if (!source->mesh) {
            return select_prob(point, receiver, source->first) * emitter->pdf_direction(point, ds);
        }
        const std::uint32_t of_triangle = source->first + hit.prim_index;
        const auto& [a, b, c] = context_.lights->triangles()[of_triangle].corners;
        const Point2f uv = barycentric(to_point(a), to_point(b), to_point(c), hit.p);
        const auto [light, density] = context_.lights->places().find(of_triangle, {uv.x(), uv.y()});
        return select_prob(point, receiver, light) * triangle_pdf(density, hit.n, ds.d, ds.dist);
    }

  private:
    bool has_choice() const { return context_.lights->lights().size() > 1; }

    Float select_prob(const Interaction3f& point, const Receiver<Float>& receiver,
                      std::uint32_t light) const {
        if (!has_choice()) return 1.0f;
        return context_.light_sampler->prob(shading_point(point.p, receiver), {}, light);
    }

    static Point3f to_point(const ::lightcull::float3& p) { return {p.x, p.y, p.z}; }

    template <typename V>
    static ::lightcull::float3 to_float3(const V& v) {
        return {v.x(), v.y(), v.z()};
    }

    static ::lightcull::ShadingPoint shading_point(const Point3f& p,
                                                   const Receiver<Float>& receiver) {
        return {to_float3(p),
                to_float3(receiver.normal),
                0,
                receiver.diffuse,
                {to_float3(receiver.axis), receiver.alpha, receiver.peak}};
    }

    Sample sample_triangle(const Interaction3f& point,
                           const typename SceneLights<Float, Spectrum>::Source& source,
                           std::uint32_t light, Sampler* sampler, Float prob,
                           Float mis_prob) const {
        auto sample = dr::zeros<Sample>();
        const auto& [index, corners] = context_.lights->triangles()[light];
        const auto& [a, b, c] = corners;
        const auto [place, density] = draw_place(context_.lights->places(), light, sampler);
        const Point2f uv(place.x, place.y);
        const Point3f p0 = to_point(a), p1 = to_point(b), p2 = to_point(c);
        sample.p = p0 * (1.0f - uv.x() - uv.y()) + p1 * uv.x() + p2 * uv.y();
        const Vector3f way = sample.p - point.p;
        const Float distance = dr::norm(way);
        if (!(distance > 0.0f)) return sample;
        sample.direction = way / distance;
        SurfaceInteraction3f at = triangle_point<Float, Spectrum>(source.mesh, index, uv);
        at.wi = at.to_local(-sample.direction);
        at.wavelengths = point.wavelengths;
        at.time = point.time;
        const Float pdf = triangle_pdf(density, at.n, sample.direction, distance);
        sample.active = dr::isfinite(pdf);
        sample.weight = source.emitter->eval(at) / (prob * pdf);
        sample.pdf = mis_prob * pdf;
        return sample;
    }

    Sample sample_whole(const Interaction3f& point, const Emitter* emitter, const Point2f& random,
                        Float prob, Float mis_prob) const {
        const auto [ds, weight] = emitter->sample_direction(point, random);
        return {ds.p, ds.d, weight / prob, mis_prob * ds.pdf, ds.delta, ds.pdf > 0.0f};
    }

    const PathContext<Float, Spectrum>& context_;
};

}  // namespace mitsuba::culling
