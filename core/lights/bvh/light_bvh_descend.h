#pragma once

#include <cstddef>
#include <cstdint>

#include "lights/bvh/light_bvh.h"
#include "lights/light/receiver.h"

namespace lightcull {

/// A selection on its way from the root to a light.
struct LightBvhDescent {
    Receiver receiver;
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
