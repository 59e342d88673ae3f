#pragma once

#include "virtual_lights/light/virtual_light.h"

#include <lightcull/render/renderer.h>
#include <lightcull/virtual_lights/virtual_light_renderer.h>

#include <vector>

namespace lightcull {

/// The reach of RandomRanges, in metres, for virtual lights like these: from the error bound, or
/// for as many accepted lights per pixel as options.range asks for. Throws Error if options.range
/// makes no sense.
float calibrate_reach(const std::vector<VirtualLight>& lights, const VirtualLightOptions& options,
                      const Scene& scene, const RenderSettings& settings);

}  // namespace lightcull
