#pragma once

#include <mitsuba/core/properties.h>

#include <cstddef>
#include <string>

namespace mitsuba::culling {

/// The description of the light sampler that chooses within kernels, and that needs no passes.
inline constexpr const char* kMeans = "light_bvh:importance=means";

/// The description of the light sampler, as lightcull::make_sampler() takes it, from the
/// integrator's parameters `light_sampler` (a description; learned unless given, or culled with the
/// others), `error_bound` (a number or "auto") and `sets` (a whole number), which are added to it.
/// Throws for what make_sampler() would refuse.
std::string sampler_description(const Properties& properties);

/// Whether one of `light_count` lights is best chosen as a light BVH with the importance by means
/// does. That is so for a sampler that is one, and for any where there is nothing to choose; and
/// for culled and learned up to 64 lights, triangles that are cut being one each, which culled
/// would all weigh: the variance is the same.
bool chooses_by_means(const std::string& description, std::size_t light_count,
                      std::size_t uncut_count);

}  // namespace mitsuba::culling
