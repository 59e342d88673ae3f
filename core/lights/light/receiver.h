#pragma once

#include <lightcull/light_sampler.h>

#include <cmath>

#include "base/float3_math.h"
#include "lights/light/light_record.h"

namespace lightcull {

/// A point to be lit, as all that weighs lights takes it.
struct Receiver {
    float3 position;       ///< in the units of the lights
    float3 normal;         ///< 0: light from all sides counts alike
    float from_all_sides;  ///< 4 if the normal is 0, else 0
    float rounding;        ///< what the position may be off
    float horizon;         ///< what lies lower cannot reach the point
    float diffuse = 1.0f;  ///< in units of `peak`
    float3 axis{0, 0, 1};  ///< of the glossy lobe
    float alpha2 = 1.0f;   ///< the square of its alpha
    float peak = 0.0f;     ///< 0: diffuse alone, whose albedo then does not matter

    /// To be assigned to.
    Receiver() noexcept = default;

    /// A diffuse one.
    Receiver(float3 x, float3 n) noexcept : position(x), normal(n) {
        const bool volume = n.x == 0.0f && n.y == 0.0f && n.z == 0.0f;
        from_all_sides = volume ? 4.0f : 0.0f;
        constexpr float kRounding = 1e-6f;
        rounding = kRounding * (1.0f + std::abs(x.x) + std::abs(x.y) + std::abs(x.z));
        horizon = volume ? -1e30f : -rounding;
    }

    /// A caller's point among the lights of a table.
    Receiver(const Frame& frame, const ShadingPoint& point) noexcept
        : Receiver(frame.position(point.position), point.normal) {
        diffuse = point.diffuse;
        axis = point.lobe.axis;
        alpha2 = point.lobe.alpha * point.lobe.alpha;
        peak = point.lobe.peak;
    }

    bool has_lobe() const noexcept { return peak > 0.0f; }
};

}  // namespace lightcull
