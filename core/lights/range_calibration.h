#pragma once

#include <lightcull/samplers.h>

#include "lights/light_record.h"
#include "lights/ranges.h"

namespace lightcull {

/// The factor by which a light's intensity is to be multiplied for the square of its range at
/// xi = 1, in the units of the table: 1 / alpha_i is reach * intensity. From options.error_bound,
/// or by bisection for options.expected_accepted lights of importance above 0 per point.
/// Throws Error for options that make no sense.
float calibrate_reach(const LightTable& table, const RangeOptions& options, RangeLaw law);

}  // namespace lightcull
