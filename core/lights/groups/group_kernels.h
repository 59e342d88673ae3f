#pragma once

#include <lightcull/span.h>

#include <cstdint>

#include "lights/groups/packet_select.h"

namespace lightcull {

class RangeTree;
struct LightGroup;

/// The work that is done with groups of lights, for one instruction set; all of them give the same
/// bits.
struct GroupKernels {
    float (*importance)(const LightGroup& group, const Receiver& receiver);

    /// Weighs groups whose ranges cover the point by g / p: adds them in their order to what is, to
    /// the bit, Reservoir(u) after Reservoir::add(record, g, g / p). Vectorised across the groups.
    void (*weigh)(const RangeTree& tree, const LightGroup* groups,
                  Span<const std::uint32_t> records, const Receiver& receiver, std::uint32_t u_bits,
                  GroupChoice& choice);

    /// Walks the tree and weighs what is found for all receivers of a packet at once,
    /// vectorised across them; `choice` is all 0 at first.
    void (*select_packet)(const RangeTree& tree, const LightGroup* groups,
                          const ReceiverPacket& receivers, const PacketRandom& random,
                          PacketChoice& choice);
};

/// The kernels for the instruction set in use.
const GroupKernels& group_kernels() noexcept;

}  // namespace lightcull
