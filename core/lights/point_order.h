#pragma once

#include <lightcull/light_sampler.h>

#include <cstdint>
#include <vector>

namespace lightcull {

/// Indices of the points, those of one set together, and among them along a Morton curve through
/// the box of all points, so that neighbours in the order are neighbours in space.
std::vector<std::uint32_t> order_points(Span<const ShadingPoint> points, std::uint32_t set_count);

}  // namespace lightcull
