#pragma once

#include <utility>

#include "paths/path_context.h"
#include "volume/scene_media.h"
#include "volume/volume_lights.h"

namespace mitsuba::culling {

/// Traces paths through `media`, from the camera, which is in `medium` (null: in none): in scalar
/// variants one, in LLVM variants those of all rays of `active`, in one kernel. It returns what
/// Integrator::sample() does.
template <typename Float, typename Spectrum>
std::pair<Spectrum, dr::mask_t<Float>> trace_volume(
    const PathContext<Float, Spectrum>& context, const VolumeLights<Float, Spectrum>& lights,
    SceneMedia media, const Medium<Float, Spectrum>* medium, Sampler<Float, Spectrum>* sampler,
    const RayDifferential<Point<Float, 3>, Spectrum>& rays, const dr::mask_t<Float>& active);

}  // namespace mitsuba::culling
