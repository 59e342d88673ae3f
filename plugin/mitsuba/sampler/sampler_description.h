#pragma once

#include <mitsuba/core/properties.h>

#include <string>

namespace mitsuba::culling {

/// The description of the light sampler, as lightcull::make_sampler() takes it, from the
/// integrator's parameters `light_sampler` (uniform, power, light_bvh or culled; culled unless
/// given), `error_bound` (a number or "auto") and `sets` (a whole number). Throws for another name
/// or type.
std::string sampler_description(const Properties& properties);

}  // namespace mitsuba::culling
