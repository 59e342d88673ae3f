#pragma once

#include <mitsuba/core/ray.h>
#include <mitsuba/render/medium.h>
#include <mitsuba/render/sampler.h>

#include <cstdint>
#include <tuple>

namespace mitsuba::culling {

/// Flights through media: how far light goes until it meets something. Each distance is sampled by
/// the extinction of a channel of its own, and weighted by the mean of the densities of all.
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
        MediumInteraction3f mei = point(ray, 0.0f, medium);
        mei.combined_extinction = medium->get_majorant(mei, active);
        const Float majorant = any_of(mei.combined_extinction, sampler->next_1d(active));
        const auto [meets, near, far] = medium->intersect_aabb(ray);
        const Mask inside = active && meets && (dr::isfinite(near) || dr::isfinite(far));
        mei.mint = dr::select(inside, dr::maximum(near, 0.0f), 0.0f);
        const Float t = mei.mint - dr::log(1.0f - sampler->next_1d(active)) / majorant;
        const Mask valid = inside && t <= dr::minimum(ray.maxt, far);
        mei.t = dr::select(valid, t, dr::Infinity<Float>);
        mei.p = ray(t);
        std::tie(mei.sigma_s, mei.sigma_n, mei.sigma_t) =
            medium->get_scattering_coefficients(mei, valid);
        return mei;
    }

    /// The weight of a sampled flight that ends at `t`, by meeting the medium or not: transmittance
    /// divided by density. Both are taken relative to the largest transmittance, which cancels out
    /// and may be too small for a float.
    static Spectrum weight(const MediumInteraction3f& mei, const Float& t, const Mask& meets) {
        const Float length = dr::minimum(t, dr::Largest<Float>) - mei.mint;
        const Spectrum& extinction = mei.combined_extinction;
        const Spectrum transmittance = dr::exp(-length * (extinction - dr::min(extinction)));
        const Spectrum density = dr::select(meets, transmittance * extinction, transmittance);
        const Float pdf = dr::mean(density);
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
    /// One of the channels, by a number in [0, 1).
    static Float any_of(const Spectrum& spectrum, const Float& random) {
        constexpr std::uint32_t kChannels = dr::size_v<Spectrum>;
        Float any = spectrum[0];
        for (std::uint32_t i = 1; i < kChannels; ++i) {
            dr::masked(any, random * static_cast<float>(kChannels) >= static_cast<float>(i)) =
                spectrum[i];
        }
        return any;
    }
};

}  // namespace mitsuba::culling
