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

/// Derives the light along the rays by what in the scene has derivatives: emission, and what BSDFs
/// depend on. It traces the paths, and then once more with the same numbers ([Vicini et al. 2021]).
/// Backward: adds to the gradients of the scene, once the kernel has run, those of the sum of
/// change * light over the rays. Forward: returns the derivative of the light, where `change` is 0.
/// Lights are chosen, and points on them and directions sampled, as if nothing changed. Throws if
/// nothing has derivatives.
template <typename Float, typename Spectrum>
Spectrum derive_loop(const PathContext<Float, Spectrum>& context, Sampler<Float, Spectrum>* sampler,
                     const RayDifferential<Point<Float, 3>, Spectrum>& rays,
                     const LightTables<Float, Spectrum>& tables, const LightBvhArrays<Float>& bvh,
                     const dr::mask_t<Float>& active, dr::ADMode mode, const Spectrum& change);

}  // namespace mitsuba::culling
