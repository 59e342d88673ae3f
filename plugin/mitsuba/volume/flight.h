#pragma once

#include <mitsuba/core/ray.h>
#include <mitsuba/render/medium.h>
#include <mitsuba/render/sampler.h>

#include <cstdint>

namespace mitsuba::culling {

/// Flights through media: how far light goes until it meets something, by the channels that
/// distances are sampled by. Each distance is sampled by a channel of its own, and weighted by the
/// mean of the densities of all channels, in RGB; in spectral variants by the first wavelength.
template <typename Float, typename Spectrum>
class Flight {
  public:
    MI_IMPORT_TYPES(Sampler, Medium, MediumPtr)

    /// A point in the medium, `t` along the ray, without the coefficients of the medium.
    static MediumInteraction3f point(const Ray3f& ray, const Float& t, const MediumPtr& medium) {
        auto mei = dr::zeros<MediumInteraction3f>();
        mei.t = t;
        mei.p = ray(t);
        mei.time = ray.time;
        mei.wavelengths = ray.wavelengths;
        mei.wi = -ray.d;
        mei.sh_frame = Frame3f(mei.wi);
        mei.medium = medium;
        return mei;
    }

    /// Samples where a ray meets the medium, up to its maxt: an interaction that is not valid where
    /// it meets nothing.
    static MediumInteraction3f sample(const Ray3f& ray, const MediumPtr& medium, Sampler* sampler,
                                      const Mask& active) {
        UInt32 channel(0);
        if constexpr (is_rgb_v<Spectrum>) {
            const Float random = sampler->next_1d(active);
            channel = dr::minimum(UInt32(random * static_cast<float>(kChannels)), kChannels - 1u);
        }
        return medium->sample_interaction(ray, sampler->next_1d(active), channel, active);
    }

    /// The weight of a sampled flight that ends at `t`, by meeting the medium or not: transmittance
    /// divided by density. Both are taken relative to the largest transmittance, which cancels out
    /// and may be too small for a float.
    static Spectrum weight(const MediumInteraction3f& mei, const Float& t, const Mask& meets) {
        const Float length = dr::minimum(t, dr::Largest<Float>) - mei.mint;
        const Spectrum& extinction = mei.combined_extinction;
        const Spectrum transmittance = dr::exp(-length * (extinction - dr::min(extinction)));
        const Spectrum density = dr::select(meets, transmittance * extinction, transmittance);
        Float pdf = density[0];
        if constexpr (is_rgb_v<Spectrum>) pdf = dr::mean(density);
        return dr::select(pdf > 0.0f, transmittance / pdf, 0.0f);
    }

    /// The ray from `t` on, up to a distance `end` from its origin.
    static Ray3f rest(const Ray3f& ray, const Float& t, const Float& end) {
        Ray3f rest = ray;
        rest.o = ray(t);
        rest.maxt = end - t;
        return rest;
    }

  private:
    static constexpr std::uint32_t kChannels = dr::size_v<Spectrum>;
};

}  // namespace mitsuba::culling
