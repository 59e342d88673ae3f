#pragma once

#include <cstddef>
#include <cstdint>

#include "lights/light_bvh_descend.h"
#include "lights/packet_select.h"

namespace lightcull {

class RangeTree;
struct FoundLeaves;
struct LightGroup;
struct Refit;
struct SphereTree;
struct TreeWalk;

/// The loops that matter, compiled for one instruction set; all of them give the same bits.
struct Kernels {
    /// Goes on with a walk until it is over (stack_size 0) or `found`, which is emptied first, is
    /// full. Vectorised across the slots of a node.
    void (*find_leaves)(const SphereTree& tree, const float* radii, const LightBvhPoint& point,
                        TreeWalk& walk, FoundLeaves& found);

    /// Weighs every group that is accepted at any of the points, in one walk of the tree; what goes
    /// into `choice`, all 0 at first, is what one Reservoir after another would hold.
    void (*select_packet)(const RangeTree& tree, const LightGroup* groups,
                          const PointPacket& points, PacketChoice& choice);

    /// The nodes [begin, end) of a refit, the last one first.
    void (*refit_nodes)(const Refit& refit, std::size_t begin, std::size_t end);

    LightBvhKernels<BoundsNode> bounds;
    LightBvhKernels<MeansNode> means;

    template <typename Node>
    const LightBvhKernels<Node>& of_bvh() const noexcept;
};

template <>
inline const LightBvhKernels<BoundsNode>& Kernels::of_bvh() const noexcept {
    return bounds;
}
template <>
inline const LightBvhKernels<MeansNode>& Kernels::of_bvh() const noexcept {
    return means;
}

/// Those for the instruction set in use.
const Kernels& kernels() noexcept;

/// One lane at a time, for any machine.
const Kernels& scalar_kernels() noexcept;

}  // namespace lightcull
