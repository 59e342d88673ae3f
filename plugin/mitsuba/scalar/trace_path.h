#pragma once

#include <utility>

#include "paths/path_context.h"
#include "sampler/range_sets.h"

namespace mitsuba::culling {

/// Traces one path: the light along a camera ray, and whether it met anything, as
/// Integrator::sample() returns them. `sets` are the sets of random ranges that the path uses.
template <typename Float, typename Spectrum>
std::pair<Spectrum, bool> trace_path(const PathContext<Float, Spectrum>& context,
                                     Sampler<Float, Spectrum>* sampler,
                                     const RayDifferential<Point<Float, 3>, Spectrum>& ray,
                                     const PathSets& sets);

}  // namespace mitsuba::culling
