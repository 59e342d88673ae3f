#pragma once

#include <lightcull/light.h>
#include <lightcull/span.h>

namespace lightcull {

/// The share of narrow cones in the intensity of all lights: of lights that emit only within
/// `angle` (radians, below pi / 2) of their axis. Narrow cones side by side light different places,
/// so that no importance of a cluster of them is true.
double share_of_narrow_cones(Span<const Light> lights, float angle) noexcept;

/// The share above which lights are not to be taken together, found by trial on stages of spots.
inline constexpr double kManyNarrowCones = 0.25;

}  // namespace lightcull
