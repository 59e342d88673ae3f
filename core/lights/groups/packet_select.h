#pragma once

#include <cstdint>

#include "lights/light/receiver_packet.h"

namespace lightcull {

/// What the receivers of a packet choose by.
struct alignas(64) PacketRandom {
    std::uint32_t u_bits[ReceiverPacket::kSize];  ///< as Reservoir has them
};

/// What a Reservoir of groups holds at the end.
struct GroupChoice {
    float weight_sum = 0.0f;
    float numerator = 0.0f;
    std::uint32_t record = 0;
};

/// The same for each receiver of a packet.
struct alignas(64) PacketChoice {
    float weight_sum[ReceiverPacket::kSize];
    float numerator[ReceiverPacket::kSize];
    std::uint32_t record[ReceiverPacket::kSize];
};

}  // namespace lightcull
