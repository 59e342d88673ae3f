#pragma once

#include <cstddef>
#include <cstdint>

#include "lights/bvh/light_bvh.h"
#include "lights/light/receiver.h"

namespace lightcull {

/// A selection on its way from the root to a light.
struct LightBvhDescent {
    Receiver receiver;
    double place = 0.0;       ///< place in the share of `child` where the choice falls, [0, 1)
    double prob = 1.0;        ///< probability of `child`; 0: none of its lights can reach the point
    std::uint32_t child = 0;  ///< a child, in the form of BoundsNode::child
};

/// Importances of a node's children, in the order of its slots.
struct LightBvhImportances {
    alignas(32) float of[LightBvhNode::kWidth];
};

/// The most descents that LightBvhKernels::descend takes at once.
inline constexpr std::size_t kMaxDescents = 16;

}  // namespace lightcull
