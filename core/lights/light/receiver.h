#pragma once

#include <lightcull/light_sampler.h>

#include <cmath>

#include "base/float3_math.h"
#include "lights/light/light_record.h"

namespace lightcull {

/// A point to be lit, in the form that all code that weighs lights takes.
struct Receiver {
    float3 position;       ///< position in the units of the lights
    float3 normal;         ///< 0: light from all sides counts alike
    float from_all_sides;  ///< flag: 4 if the normal is 0, else 0
    float rounding;        ///< bound on what the position may be off
    float horizon;         ///< height below which nothing can reach the point
    float diffuse = 1.0f;  ///< diffuse part, in units of `peak`
    float3 axis{0, 0, 1};  ///< axis of the glossy lobe
    float alpha2 = 1.0f;   ///< square of the lobe's alpha
    float peak = 0.0f;  ///< peak of the lobe; 0: diffuse alone, whose albedo then does not matter

    /// Makes a receiver that is to be assigned to.
    Receiver() noexcept = default;

    /// Makes a diffuse receiver.
    Receiver(float3 x, float3 n) noexcept : position(x), normal(n) {
        const bool volume = n.x == 0.0f && n.y == 0.0f && n.z == 0.0f;
        from_all_sides = volume ? 4.0f : 0.0f;
        constexpr float kRounding = 1e-6f;
        rounding = kRounding * (1.0f + std::abs(x.x) + std::abs(x.y) + std::abs(x.z));
        horizon = volume ? -1e30f : -rounding;
    }

    /// Makes a receiver of a caller's point among the lights of a table.
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
