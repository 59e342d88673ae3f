#pragma once

#include "render/surface.h"
#include "render/virtual_emitter.h"

#include <vector>

namespace lightcull {

/// Appends to `lights` the lights, none, one or two, that `flux` (W) makes of a surface that it
/// meets.
void add_virtual_lights(const Surface& surface, const V3f& incoming, const V3f& flux,
                        std::vector<VirtualLight>& lights);

}  // namespace lightcull
