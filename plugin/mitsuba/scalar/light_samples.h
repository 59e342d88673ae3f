#pragma once

#include <lightcull/light_sampler.h>

#include <mitsuba/core/warp.h>
#include <mitsuba/render/sampler.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "paths/draw_place.h"
#include "paths/path_context.h"
#include "scene/light_sample.h"
#include "scene/surface_receiver.h"
#include "scene/triangle_pdf.h"
#include "scene/triangle_point.h"

namespace mitsuba::culling {

template <typename Vector>
::lightcull::float3 to_float3(const Vector& v) {
    return {v.x(), v.y(), v.z()};
}

/// A point as a light sampler takes it.
template <typename Point, typename Float>
::lightcull::ShadingPoint shading_point(const Point& p, const Receiver<Float>& receiver,
                                        std::uint32_t set) {
    return {to_float3(p),
            to_float3(receiver.normal),
            set,
            receiver.diffuse,
            {to_float3(receiver.axis), receiver.alpha, receiver.peak}};
}

/// Samples of lights in scalar variants, seen from a point. A sample that would bring nothing is
/// not active. select_prob(p): the probability with which the light was chosen, if p is sampled on
/// it; mis_prob: what stands for it in weights.
template <typename Float, typename Spectrum>
class LightSamples {
  public:
    MI_IMPORT_TYPES(Scene, Sampler, Emitter)

    using Sample = LightSample<Float, Spectrum>;

    explicit LightSamples(const PathContext<Float, Spectrum>& context) : context_(context) {}

    template <typename SelectProb>
    Sample of_light(const Interaction3f& from, std::uint32_t light, Sampler* sampler,
                    const SelectProb& select_prob, Float mis_prob) const {
        const auto& source = context_.lights->source_of(light);
        return source.mesh ? of_triangle(from, source, light, sampler, select_prob, mis_prob)
                           : of_emitter(from, source.emitter, sampler, select_prob, mis_prob);
    }

    /// Of one of the emitters without a place. There must be one.
    Sample of_unplaced(const Interaction3f& from, Sampler* sampler) const {
        const auto& unplaced = context_.lights->unplaced();
        std::size_t chosen = 0;
        if (unplaced.size() > 1) {
            Float u = sampler->next_1d();
            while (chosen + 1 < unplaced.size() && u >= unplaced[chosen].prob) {
                u -= unplaced[chosen++].prob;
            }
        }
        const Float prob = unplaced[chosen].prob;
        return of_emitter(
            from, unplaced[chosen].emitter, sampler, [prob](const Point3f&) { return prob; }, prob);
    }

    /// The barycentric coordinates of a point of the triangle of which `light` is the first part.
    Point2f place_of(const Point3f& p, std::uint32_t light) const {
        const auto& [a, b, c] = context_.lights->triangles()[light].corners;
        return barycentric(to_point(a), to_point(b), to_point(c), p);
    }

    /// The density with which `hit`, of `emitter`, is sampled as a light. place_of(triangle): its
    /// barycentric coordinates in the triangle of which that light is the first part; prob(light):
    /// with what probability a light is chosen.
    template <typename PlaceOf, typename Prob>
    Float pdf(const Interaction3f& from, const SurfaceInteraction3f& hit, const Emitter* emitter,
              const PlaceOf& place_of, const Prob& prob) const {
        const DirectionSample3f ds(context_.scene, hit, from);
        const auto* source = context_.lights->find(emitter);
        if (!source) {
            const Float chosen = context_.lights->unplaced_prob(emitter);
            return chosen > 0.0f ? chosen * emitter->pdf_direction(from, ds) : 0.0f;
        }
        if (!source->mesh) return prob(source->first) * emitter->pdf_direction(from, ds);
        const std::uint32_t triangle = source->first + hit.prim_index;
        const Point2f uv = place_of(triangle);
        const auto [light, density] = context_.lights->places().find(triangle, {uv.x(), uv.y()});
        return prob(light) * triangle_pdf(density, hit.n, ds.d, ds.dist);
    }

  private:
    static Point3f to_point(const ::lightcull::float3& p) { return {p.x, p.y, p.z}; }

    template <typename SelectProb>
    Sample of_triangle(const Interaction3f& from,
                       const typename SceneLights<Float, Spectrum>::Source& source,
                       std::uint32_t light, Sampler* sampler, const SelectProb& select_prob,
                       Float mis_prob) const {
        auto sample = dr::zeros<Sample>();
        const auto& [index, corners] = context_.lights->triangles()[light];
        const auto& [a, b, c] = corners;
        const auto [place, density] = draw_place(context_.lights->places(), light, sampler);
        const Point2f uv(place.x, place.y);
        const Point3f p0 = to_point(a), p1 = to_point(b), p2 = to_point(c);
        sample.p = p0 * (1.0f - uv.x() - uv.y()) + p1 * uv.x() + p2 * uv.y();
        const Vector3f way = sample.p - from.p;
        const Float distance = dr::norm(way);
        if (!(distance > 0.0f)) return sample;
        sample.direction = way / distance;
        SurfaceInteraction3f at = triangle_point<Float, Spectrum>(source.mesh, index, uv);
        at.wi = at.to_local(-sample.direction);
        at.wavelengths = from.wavelengths;
        at.time = from.time;
        const Spectrum radiance = source.emitter->eval(at);
        const Float pdf = triangle_pdf(density, at.n, sample.direction, distance);
        if (!std::isfinite(pdf) || dr::all(unpolarized_spectrum(radiance) == 0.0f)) return sample;
        const Float prob = select_prob(sample.p);
        if (!(prob > 0.0f)) return sample;
        sample.weight = radiance / (prob * pdf);
        sample.pdf = mis_prob * pdf;
        sample.active = true;
        return sample;
    }

    /// Of an emitter that Mitsuba samples.
    template <typename SelectProb>
    Sample of_emitter(const Interaction3f& from, const Emitter* emitter, Sampler* sampler,
                      const SelectProb& select_prob, Float mis_prob) const {
        const auto [ds, weight] = emitter->sample_direction(from, sampler->next_2d());
        if (!(ds.pdf > 0.0f)) return dr::zeros<Sample>();
        const Float prob = select_prob(ds.p);
        if (!(prob > 0.0f)) return dr::zeros<Sample>();
        return {ds.p, ds.d, weight / prob, mis_prob * ds.pdf, ds.delta, true};
    }

    const PathContext<Float, Spectrum>& context_;
};

}  // namespace mitsuba::culling
