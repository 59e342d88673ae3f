#pragma once

#include "virtual_lights/tiles/pixel_lighting.h"

#include <lightcull/span.h>

namespace lightcull {

/// Adds to each pixel what the lights give it in whose rectangle it lies: for comparison with
/// tiles. Without shadow rays. Runs in the caller's TBB arena.
LightingCounts splat_lights(const PassLights& lights, Span<V3f> pixels);

}  // namespace lightcull
