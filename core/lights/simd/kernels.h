#pragma once

#include <cstddef>
#include <cstdint>

#include "base/core_export.h"
#include "lights/bvh/light_bvh_descend.h"
#include "lights/bvh/packet_select.h"

namespace lightcull {

class RangeTree;
class TreeWalk;
struct FoundLeaves;
struct LightGroup;
struct Refit;
struct SphereTree;

/// The loops that matter, compiled for one instruction set; all of them give the same bits.
struct Kernels {
    /// Goes on with a walk until it is over or `found`, whose records are emptied first, is full.
    /// Vectorised across the slots of a node.
    void (*find_leaves)(const SphereTree& tree, const float* radii, const LightBvhPoint& point,
                        TreeWalk& walk, FoundLeaves& found);

    float (*group_importance)(const LightGroup& group, const LightBvhPoint& point);

    /// Weighs groups whose ranges cover the point by g / p: adds them in their order to what is, to
    /// the bit, Reservoir(u) after Reservoir::add(record, g, g / p). Vectorised across the groups.
    void (*weigh_groups)(const RangeTree& tree, const LightGroup* groups,
                         Span<const std::uint32_t> records, const LightBvhPoint& point,
                         std::uint32_t u_bits, GroupChoice& choice);

    /// Both together for all points of a packet, in one walk of the tree, vectorised across the
    /// points; `choice` is all 0 at first.
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
LIGHTCULL_CORE_EXPORT const Kernels& kernels() noexcept;

/// One lane at a time, for any machine.
const Kernels& scalar_kernels() noexcept;

}  // namespace lightcull
