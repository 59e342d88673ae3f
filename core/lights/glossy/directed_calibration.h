#pragma once

#include "lights/calibration/range_calibration.h"

namespace lightcull {

/// The scene of the lit lights of a table, with the distances that DirectedLight has. The table
/// must outlive it.
RangedScene directed_scene(const LightTable& table);

}  // namespace lightcull
