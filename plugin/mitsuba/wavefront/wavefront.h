#pragma once

#include <cstdint>
#include <utility>

#include "paths/path_context.h"
#include "wavefront/lane_selector.h"

namespace mitsuba::culling {

/// What the paths of one pass have of their own.
struct WavefrontPass {
    SetPattern pattern;
    LaneMemory& memory;
    std::uint32_t seed;
};

/// The light along the camera rays of a pass, and whether each met anything, as
/// Integrator::sample() has it. All paths go one bounce at a time: selection is by whole arrays.
/// Ends early, with what there is, when the integrator is to stop.
template <typename Float, typename Spectrum>
std::pair<Spectrum, dr::mask_t<Float>> trace_wavefront(
    const PathSetup<Float, Spectrum>& setup, Sampler<Float, Spectrum>* sampler,
    const RayDifferential<Point<Float, 3>, Spectrum>& rays, const WavefrontPass& pass);

}  // namespace mitsuba::culling
