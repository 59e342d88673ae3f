#pragma once

#include <lightcull/light_sampler.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "lights/bvh/light_bvh.h"
#include "lights/light/importance.h"

namespace lightcull {

/// A shading point as the importance of clusters takes it.
struct LightBvhPoint {
    float3 position;       ///< in the units of the table
    float3 normal;         ///< 0: light from all sides counts alike
    float from_all_sides;  ///< 4 if the normal is 0, else 0
    float rounding;        ///< what the position may be off
    float horizon;         ///< what lies lower cannot reach the point
    float diffuse = 1.0f;  ///< this and what follows as in Receiver
    float3 axis;
    float alpha2 = 1.0f;
    float peak = 0.0f;

    LightBvhPoint() noexcept = default;
    LightBvhPoint(float3 x, const Receiver& receiver) noexcept
        : position(x),
          normal(receiver.normal),
          diffuse(receiver.diffuse),
          axis(receiver.axis),
          alpha2(receiver.alpha2),
          peak(receiver.peak) {
        const float3 n = normal;
        const bool volume = n.x == 0.0f && n.y == 0.0f && n.z == 0.0f;
        from_all_sides = volume ? 4.0f : 0.0f;
        constexpr float kRounding = 1e-6f;
        rounding = kRounding * (1.0f + std::abs(x.x) + std::abs(x.y) + std::abs(x.z));
        horizon = volume ? -1e30f : -rounding;
    }
};

/// A selection on its way from the root to a light.
struct LightBvhDescent {
    LightBvhPoint point;
    double place = 0.0;       ///< [0, 1): where in the share of `child` the choice falls
    double prob = 1.0;        ///< of `child`; 0: none of its lights can reach the point
    std::uint32_t child = 0;  ///< as BoundsNode::child
};

/// Importances of a node's children, in the order of its slots.
struct LightBvhImportances {
    alignas(32) float of[LightBvhNode::kWidth];
};

/// Of LightBvhKernels::descend.
inline constexpr std::size_t kMaxDescents = 16;

}  // namespace lightcull
