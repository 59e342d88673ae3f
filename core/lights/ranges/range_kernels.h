#pragma once

#include <cstddef>

#include "base/core_export.h"
#include "lights/light/receiver.h"

namespace lightcull {

class TreeWalk;
struct FoundLeaves;
struct Refit;
struct SphereTree;

/// The work that is done with a sphere tree, for one instruction set; all of them give the same
/// bits.
struct RangeKernels {
    /// Goes on with a walk until it is over or `found`, whose records are emptied first, is full.
    /// Vectorised across the slots of a node.
    void (*find_leaves)(const SphereTree& tree, const float* radii, const Receiver& receiver,
                        TreeWalk& walk, FoundLeaves& found);

    /// Refits the nodes [begin, end), the last one first.
    void (*refit_nodes)(const Refit& refit, std::size_t begin, std::size_t end);
};

/// The kernels for the instruction set in use.
LIGHTCULL_CORE_EXPORT const RangeKernels& range_kernels() noexcept;

}  // namespace lightcull
