#pragma once

#include "lights/calibration/range_calibration.h"
#include "lights/groups/light_groups.h"

namespace lightcull {

/// Ranges are found for groups of lights. Both must outlive it.
RangedScene ranged_scene(const LightGroups& groups, const Frame& frame);

}  // namespace lightcull
