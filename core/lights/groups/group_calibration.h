#pragma once

#include "lights/calibration/range_calibration.h"
#include "lights/groups/light_groups.h"

namespace lightcull {

/// The scene of groups of lights, for which ranges are found. Both arguments must outlive it.
RangedScene ranged_scene(const LightGroups& groups, const Frame& frame);

}  // namespace lightcull
