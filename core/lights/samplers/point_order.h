#pragma once

#include <lightcull/light_sampler.h>

#include <cstdint>
#include <vector>

namespace lightcull {

/// Indices of the points, such that those of one set and place come together: each set is ordered
/// along a Morton curve through a box around them, and then runs of it take turns with runs of
/// the other sets, so that all of them work on one place, whose memory stays near. Throws Error
/// where there is no memory for it.
std::vector<std::uint32_t> order_points(Span<const ShadingPoint> points, std::uint32_t set_count);

}  // namespace lightcull
