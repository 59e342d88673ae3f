#pragma once

#include <utility>

#include "lanes/light_tables.h"
#include "loop/light_bvh_arrays.h"
#include "paths/path_context.h"

namespace mitsuba::culling {

/// Traces the paths of all rays of `active` in one kernel, with a symbolic loop over bounces as in
/// Mitsuba's `path`: the light along the rays, and whether each met anything, as
/// Integrator::sample() returns them. Lights are chosen within the kernel.
template <typename Float, typename Spectrum>
std::pair<Spectrum, dr::mask_t<Float>> trace_loop(
    const PathContext<Float, Spectrum>& context, Sampler<Float, Spectrum>* sampler,
    const RayDifferential<Point<Float, 3>, Spectrum>& rays,
    const LightTables<Float, Spectrum>& tables, const LightBvhArrays<Float>& bvh,
    const dr::mask_t<Float>& active);

}  // namespace mitsuba::culling
