#pragma once

#include "virtual_lights/tiles/pixel_lighting.h"

#include <lightcull/span.h>

namespace lightcull {

/// Adds to each pixel the light of the lights in whose rectangle it lies: for comparison with
/// tiles. There are no shadow rays. Runs in the caller's TBB arena.
LightingCounts splat_lights(const PassLights& lights, Span<V3f> pixels);

}  // namespace lightcull
