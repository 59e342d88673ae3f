#pragma once

#include <lightcull/span.h>

#include <cstdint>

#include "lights/groups/packet_select.h"

namespace lightcull {

class RangeTree;
struct LightGroup;

/// What is done with groups of lights, for one instruction set; all of them give the same bits.
struct GroupKernels {
    float (*importance)(const LightGroup& group, const LightBvhPoint& point);

    /// Weighs groups whose ranges cover the point by g / p: adds them in their order to what is, to
    /// the bit, Reservoir(u) after Reservoir::add(record, g, g / p). Vectorised across the groups.
    void (*weigh)(const RangeTree& tree, const LightGroup* groups,
                  Span<const std::uint32_t> records, const LightBvhPoint& point,
                  std::uint32_t u_bits, GroupChoice& choice);

    /// Walks the tree and weighs what is found for all points of a packet at once, vectorised
    /// across the points; `choice` is all 0 at first.
    void (*select_packet)(const RangeTree& tree, const LightGroup* groups,
                          const PointPacket& points, PacketChoice& choice);
};

/// Those for the instruction set in use.
const GroupKernels& group_kernels() noexcept;

}  // namespace lightcull
