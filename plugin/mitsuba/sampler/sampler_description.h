#pragma once

#include <mitsuba/core/properties.h>

#include <string>

namespace mitsuba::culling {

/// The description of the light sampler, as lightcull::make_sampler() takes it, from the
/// integrator's parameters `light_sampler` (a description; learned unless given, or culled with the
/// others), `error_bound` (a number or "auto") and `sets` (a whole number), which are added to it.
/// Throws for what make_sampler() would refuse, and for `paper` with its test at the vertex.
std::string sampler_description(const Properties& properties);

/// Whether a description is that of a light BVH with the importance by means.
bool is_light_bvh_by_means(const std::string& description);

}  // namespace mitsuba::culling
