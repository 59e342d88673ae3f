#pragma once

#include <cstddef>
#include <cstdint>

#include "lights/culling_tree.h"

namespace lightcull {

/// Sixteen points of one set side by side, in the units of the tree's frame.
struct alignas(64) PointPacket {
    static constexpr std::size_t kSize = 16;

    float x[kSize], y[kSize], z[kSize];
    float normal_x[kSize], normal_y[kSize], normal_z[kSize];
    std::uint32_t u_bits[kSize];
    std::uint32_t set;
};

/// What a Reservoir holds at the end, for each point.
struct alignas(64) PacketChoice {
    float weight_sum[PointPacket::kSize];
    float numerator[PointPacket::kSize];
    std::uint32_t record[PointPacket::kSize];
};

/// Weighs every light that is accepted at any of the points, in one walk of the tree in which each
/// sphere is tested against all of them; the bits are those of one Reservoir after another. For the
/// instruction set of the machine.
void select_packet(const CullingTree& tree, const PointPacket& points,
                   PacketChoice& choice) noexcept;

}  // namespace lightcull
