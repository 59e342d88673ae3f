#pragma once

#include <mitsuba/render/sampler.h>

#include "lanes/lane_lights.h"
#include "loop/light_bvh_arrays.h"
#include "paths/path_context.h"
#include "scene/surface_receiver.h"
#include "scene/triangle_pdf.h"
#include "scene/triangle_point.h"

namespace mitsuba::culling {

/// Chooses and samples lights in LLVM variants, within a kernel: the twin of ScalarVolumeLights.
template <typename Float, typename Spectrum>
class KernelLights {
  public:
    MI_IMPORT_TYPES(Scene, Sampler, Emitter, EmitterPtr)

    using Tables = LightTables<Float, Spectrum>;
    using Sample = LightSample<Float, Spectrum>;

    KernelLights(const PathContext<Float, Spectrum>& context, const Tables& tables,
                 const LightBvhArrays<Float>& bvh, bool derives = false)
        : context_(context), tables_(tables), bvh_(bvh), lights_(tables, derives) {}

    bool has_lights() const { return !context_.lights->lights().empty(); }
    bool has_choice() const { return context_.lights->lights().size() > 1; }
    bool has_unplaced() const { return tables_.has_unplaced(); }

    /// Chooses a light for each point, and samples it. There must be one. draws: the lanes that
    /// take numbers from the sampler.
    Sample sample_light(const Interaction3f& point, const Receiver<Float>& receiver,
                        Sampler* sampler, const Mask& active, const Mask& draws) const {
        ChosenLight<Float> chosen{0u, 1.0f, 1.0f};
        if (has_choice()) {
            const Float random_1 = sampler->next_1d(draws), random_2 = sampler->next_1d(draws);
            chosen = bvh_.choose(point.p, receiver, random_1, random_2, active);
        }
        return lights_.sample_chosen(point, chosen, lights_.draw_random(*sampler), active);
    }

    /// Samples one of the emitters without a place. There must be one.
    Sample sample_unplaced(const Interaction3f& point, Sampler* sampler, const Mask& active,
                           const Mask& draws) const {
        const Float random = tables_.has_several_unplaced() ? sampler->next_1d(draws) : Float(0.0f);
        return lights_.sample_unplaced(point, random, sampler->next_2d(draws), active);
    }

    /// The barycentric coordinates of a point of the triangle of which `light` is the first part.
    Point2f place_of(const Point3f& p, const UInt32& light, const Mask& active) const {
        const auto corner = [&](std::uint32_t i) { return tables_.corner(i, light, active); };
        return barycentric(corner(0), corner(1), corner(2), p);
    }

    /// The density with which `hit`, of `emitter`, is sampled as a light from `point`.
    /// place_of(light, active): its barycentric coordinates in the triangle of which `light` is the
    /// first part.
    template <typename PlaceOf>
    Float pdf(const Interaction3f& point, const Receiver<Float>& receiver,
              const SurfaceInteraction3f& hit, const EmitterPtr& emitter, const PlaceOf& place_of,
              const Mask& active) const {
        const DirectionSample3f ds(context_.scene, hit, point);
        const auto entry = tables_.find(emitter, active);
        const Mask triangle = active && entry.kind == Tables::kTriangles;
        const Mask whole = active && entry.kind == Tables::kWhole;
        const Mask unplaced = active && entry.kind == Tables::kUnplaced;
        Float pdf = 0.0f;
        if (tables_.has_wholes() || tables_.has_unplaced()) {
            pdf = dr::select(unplaced, entry.prob, 1.0f) *
                  emitter->pdf_direction(point, ds, whole || unplaced);
        }
        UInt32 light = entry.first_light + dr::select(triangle, hit.prim_index, 0u);
        if (tables_.has_triangles()) {
            const auto place = tables_.find_place(light, place_of(light, triangle), triangle);
            dr::masked(light, triangle) = place.light;
            dr::masked(pdf, triangle) = triangle_pdf(place.density, hit.n, ds.d, ds.dist);
        }
        const Mask is_light = triangle || whole;
        dr::masked(pdf, !(is_light || unplaced)) = 0.0f;
        if (has_choice()) {
            dr::masked(pdf, is_light) = pdf * bvh_.prob(point.p, receiver, light, is_light);
        }
        return pdf;
    }

  private:
    const PathContext<Float, Spectrum>& context_;
    const Tables& tables_;
    const LightBvhArrays<Float>& bvh_;
    LaneLights<Float, Spectrum> lights_;
};

}  // namespace mitsuba::culling
