#pragma once

#include <lightcull/light_sampler.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "path_setup.h"

namespace mitsuba::culling {

/// What goes to and from a light sampler, kept from one bounce and pass to the next: to get as much
/// memory anew from the system each time would cost more than to fill it.
struct WavefrontMemory {
    // Of the lanes that choose a light.
    std::vector<std::uint32_t> users;
    std::vector<::lightcull::ShadingPoint> points;
    std::vector<float> random;
    std::vector<::lightcull::Selection> selections;
    // Of all lanes.
    std::vector<std::uint32_t> lights, sets;
    std::vector<float> hit_probs, probs, mis_probs, weight_sums;
};

/// The light along the camera rays of a pass, and whether each met anything, as
/// Integrator::sample() has it. All paths go one bounce at a time: selection is by whole arrays.
/// Ends early, with what there is, when the integrator is to stop.
template <typename Float, typename Spectrum>
std::pair<Spectrum, dr::mask_t<Float>> trace_wavefront(
    const PathSetup<Float, Spectrum>& setup, Sampler<Float, Spectrum>* sampler,
    const RayDifferential<Point<Float, 3>, Spectrum>& rays, const std::vector<PathSets>& sets,
    WavefrontMemory& memory);

}  // namespace mitsuba::culling
