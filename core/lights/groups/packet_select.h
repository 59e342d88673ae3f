#pragma once

#include <cstdint>

#include "lights/bvh/point_packet.h"

namespace lightcull {

/// What a Reservoir of groups holds at the end.
struct GroupChoice {
    float weight_sum = 0.0f;
    float numerator = 0.0f;
    std::uint32_t record = 0;
};

/// The same for each point of a packet.
struct alignas(64) PacketChoice {
    float weight_sum[PointPacket::kSize];
    float numerator[PointPacket::kSize];
    std::uint32_t record[PointPacket::kSize];
};

}  // namespace lightcull
