#pragma once

#include <utility>

#include "paths/path_context.h"

namespace mitsuba::culling {

/// The light along a camera ray, and whether it met anything, as Integrator::sample() has it.
template <typename Float, typename Spectrum>
std::pair<Spectrum, bool> trace_path(const PathSetup<Float, Spectrum>& setup,
                                     Sampler<Float, Spectrum>* sampler,
                                     const RayDifferential<Point<Float, 3>, Spectrum>& ray,
                                     const PathSets& sets);

}  // namespace mitsuba::culling
