#pragma once

#include <cstdint>

#include "scalar/light_samples.h"

namespace mitsuba::culling {

/// Chooses and samples lights in scalar variants: the twin of KernelLights.
template <typename Float, typename Spectrum>
class ScalarVolumeLights {
  public:
    MI_IMPORT_TYPES(Scene, Sampler, Emitter, EmitterPtr)

    using Sample = LightSample<Float, Spectrum>;

    explicit ScalarVolumeLights(const PathContext<Float, Spectrum>& context)
        : context_(context), samples_(context) {}

    bool has_lights() const { return !context_.lights->lights().empty(); }
    bool has_unplaced() const { return !context_.lights->unplaced().empty(); }

    /// Chooses a light for a point, and samples it. There must be one.
    Sample sample_light(const Interaction3f& point, const Receiver<Float>& receiver,
                        Sampler* sampler, bool active, bool) const {
        auto sample = dr::zeros<Sample>();
        if (!active) return sample;
        std::uint32_t light = 0;
        Float prob = 1.0f, mis_prob = 1.0f;
        if (has_choice()) {
            const auto chosen = context_.light_sampler->select(shading_point(point.p, receiver, 0),
                                                               sampler->next_1d());
            light = chosen.light;
            prob = chosen.prob;
            mis_prob = chosen.mis_prob;
        }
        if (!(prob > 0.0f)) return sample;
        return samples_.of_light(
            point, light, sampler, [prob](const Point3f&) { return prob; }, mis_prob);
    }

    /// Samples one of the emitters without a place. There must be one.
    Sample sample_unplaced(const Interaction3f& point, Sampler* sampler, bool active, bool) const {
        return active ? samples_.of_unplaced(point, sampler) : dr::zeros<Sample>();
    }

    /// The barycentric coordinates of a point of the triangle of which `light` is the first part.
    Point2f place_of(const Point3f& p, std::uint32_t light, bool) const {
        return samples_.place_of(p, light);
    }

    /// The density with which `hit`, of `emitter`, is sampled as a light from `point`.
    template <typename PlaceOf>
    Float pdf(const Interaction3f& point, const Receiver<Float>& receiver,
              const SurfaceInteraction3f& hit, const Emitter* emitter, const PlaceOf& place_of,
              bool active) const {
        if (!active) return 0.0f;
        return samples_.pdf(
            point, hit, emitter, [&](std::uint32_t triangle) { return place_of(triangle, true); },
            [&](std::uint32_t light) { return select_prob(point, receiver, light); });
    }

  private:
    bool has_choice() const { return context_.lights->lights().size() > 1; }

    Float select_prob(const Interaction3f& point, const Receiver<Float>& receiver,
                      std::uint32_t light) const {
        if (!has_choice()) return 1.0f;
        return context_.light_sampler->prob(shading_point(point.p, receiver, 0), {}, light);
    }

    const PathContext<Float, Spectrum>& context_;
    LightSamples<Float, Spectrum> samples_;
};

}  // namespace mitsuba::culling
