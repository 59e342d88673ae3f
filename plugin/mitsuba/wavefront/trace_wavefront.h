#pragma once

#include <cstdint>
#include <utility>

#include "lanes/light_tables.h"
#include "paths/path_context.h"
#include "sampler/range_sets.h"
#include "wavefront/lane_selector.h"

namespace mitsuba::culling {

/// What the paths of one pass have in common, beside the context of the render.
template <typename Float, typename Spectrum>
struct WavefrontPass {
    const LightTables<Float, Spectrum>& tables;
    SetPattern pattern;
    LaneMemory& memory;
    std::uint32_t seed;
};

/// Traces the paths of a pass: the light along its camera rays, and whether each met anything, as
/// Integrator::sample() returns them. All paths go one bounce at a time, so that lights are
/// selected by whole arrays. It ends early, with what there is, when the integrator is to stop.
template <typename Float, typename Spectrum>
std::pair<Spectrum, dr::mask_t<Float>> trace_wavefront(
    const PathContext<Float, Spectrum>& context, Sampler<Float, Spectrum>* sampler,
    const RayDifferential<Point<Float, 3>, Spectrum>& rays,
    const WavefrontPass<Float, Spectrum>& pass);

}  // namespace mitsuba::culling
