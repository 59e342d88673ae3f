#pragma once

#include "lanes/chosen_light.h"
#include "lanes/light_tables.h"
#include "scene/light_sample.h"
#include "scene/triangle_pdf.h"

namespace mitsuba::culling {

/// Samples points on the lights of a scene, for all lanes at once.
template <typename Float, typename Spectrum>
class LaneLights {
  public:
    MI_IMPORT_TYPES(Scene, Emitter, EmitterPtr, Shape, ShapePtr)

    using Sample = LightSample<Float, Spectrum>;
    using Tables = LightTables<Float, Spectrum>;

    /// `derives`: the weights of samples carry the derivatives of emission, and nothing else does.
    explicit LaneLights(const LightTables<Float, Spectrum>& tables, bool derives = false)
        : tables_(tables), derives_(derives) {}

    /// Random numbers in [0, 1) for a point on a light.
    struct Random {
        Float piece_1, piece_2;  ///< these are not used unless the tables have pieces
        Point2f place;
    };

    /// Draws them from what has next_1d() and next_2d().
    template <typename Source>
    Random draw_random(Source& source) const {
        Random random;
        if (tables_.has_pieces()) {
            random.piece_1 = source.next_1d();
            random.piece_2 = source.next_1d();
        }
        random.place = source.next_2d();
        return random;
    }

    /// Samples the lights that were chosen.
    Sample sample_chosen(const Interaction3f& point, const ChosenLight<Float>& chosen,
                         const Random& random, const Mask& active) const {
        const Mask found = active && chosen.prob > 0.0f;
        const EmitterPtr emitter = tables_.emitter(chosen.light, found);
        if (!tables_.has_triangles()) {
            return sample_whole(point, emitter, random.place, chosen.prob, chosen.mis_prob, found);
        }
        const UInt32 triangle = tables_.triangle(chosen.light, found);
        if (!tables_.has_wholes()) {
            return sample_triangle(point, emitter, triangle, chosen, random, found);
        }
        const Mask is_triangle = triangle != Tables::kNoTriangle;
        const Mask whole = found && !is_triangle;
        const Sample of_whole =
            sample_whole(point, emitter, random.place, chosen.prob, chosen.mis_prob, whole);
        const Sample of_triangle =
            sample_triangle(point, emitter, triangle, chosen, random, found && is_triangle);
        const dr::resume_grad<Float> derivatives(derives_);
        return dr::select(whole, of_whole, of_triangle);
    }

    /// Samples one of the emitters without a place. The first number chooses among several.
    Sample sample_unplaced(const Interaction3f& point, const Float& random_1,
                           const Point2f& random_2, const Mask& active) const {
        const auto [emitter, prob] = tables_.unplaced(random_1);
        return sample_whole(point, emitter, random_2, prob, prob, active);
    }

  private:
    Sample sample_triangle(const Interaction3f& point, const EmitterPtr& emitter,
                           const UInt32& triangle, const ChosenLight<Float>& chosen,
                           const Random& random, const Mask& active) const {
        const auto [uv, density] =
            tables_.draw_place(chosen.light, random.piece_1, random.piece_2, random.place, active);
        Sample sample;
        sample.p = tables_.corner(0, chosen.light, active) * (1.0f - uv.x() - uv.y()) +
                   tables_.corner(1, chosen.light, active) * uv.x() +
                   tables_.corner(2, chosen.light, active) * uv.y();
        const Vector3f way = sample.p - point.p;
        const Float distance = dr::norm(way);
        sample.direction = way / distance;

        auto hit = dr::zeros<PreliminaryIntersection3f>();
        hit.t = distance;
        hit.prim_uv = uv;
        hit.prim_index = triangle;
        hit.shape = dr::select(active, emitter->shape(), dr::zeros<ShapePtr>());
        const Ray3f ray(point.p, sample.direction, point.time, point.wavelengths);
        const SurfaceInteraction3f at =
            hit.compute_surface_interaction(ray, +RayFlags::All, active);
        const Float pdf = triangle_pdf(density, at.n, sample.direction, distance);
        sample.active = active && dr::isfinite(pdf);
        sample.pdf = chosen.mis_prob * pdf;
        sample.delta = false;
        const dr::resume_grad<Float> derivatives(derives_);
        sample.weight = emitter->eval(at, sample.active) / (chosen.prob * pdf);
        return sample;
    }

    /// Samples emitters as Mitsuba does.
    Sample sample_whole(const Interaction3f& point, const EmitterPtr& emitter,
                        const Point2f& random, const Float& select_prob, const Float& mis_prob,
                        const Mask& active) const {
        auto [ds, weight] = emitter->sample_direction(point, random, active);
        Sample sample;
        sample.p = ds.p;
        sample.direction = ds.d;
        sample.pdf = mis_prob * ds.pdf;
        sample.delta = ds.delta;
        sample.active = active && ds.pdf > 0.0f;
        const dr::resume_grad<Float> derivatives(derives_);
        if (derives_) weight = emitter->eval_direction(point, ds, sample.active) / ds.pdf;
        sample.weight = weight / select_prob;
        return sample;
    }

    const Tables& tables_;
    bool derives_;
};

}  // namespace mitsuba::culling
