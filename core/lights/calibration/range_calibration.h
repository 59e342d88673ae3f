#pragma once

#include <lightcull/samplers.h>

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "base/core_export.h"
#include "lights/light/importance.h"
#include "lights/light/light_record.h"
#include "lights/light/receiver.h"
#include "lights/ranges/ranges.h"

namespace lightcull {

/// The lights, or groups of lights that share a range, for which ranges are found.
struct RangedScene {
    const Frame& frame;
    std::vector<RangedLight> lights;  ///< lights or groups of intensity above 0
    /// The distance from a point to an element of `lights`, as its p takes it; infinite where
    /// nothing of it can reach the point.
    std::function<float(std::size_t, const Receiver&)> distance;
    static constexpr float kOutOfReach = std::numeric_limits<float>::infinity();
};

/// The scene of the lit lights of a table, which must outlive it.
RangedScene ranged_scene(const LightTable& table);

/// True if a light gives a point anything, visibility aside. way: from one to the other.
bool reaches(const LightRecord& light, const Approach& way, const Receiver& x) noexcept;

/// The reach with which all is accepted that may reach a point, but for the strangest scenes.
inline constexpr float kGreatestReach = 1e18f;

/// The factor by which an intensity is to be multiplied for the square of its range at xi = 1, in
/// the units of the frame: 1 / alpha_i is reach * intensity. It follows from options.error_bound,
/// or by bisection from options.expected_accepted of the lights per point that can reach it, in
/// the mean over the points that any light reaches.
/// points: SamplerContext::calibration_points. Throws Error for points that are not finite.
LIGHTCULL_CORE_EXPORT float calibrate_reach(const RangedScene& scene, const RangeOptions& options,
                                            Span<const ShadingPoint> points, RangeLaw law);

}  // namespace lightcull
