#pragma once

#include <cstdint>

#include "lights/light/receiver_packet.h"

namespace lightcull {

/// The random numbers by which the receivers of a packet choose.
struct alignas(64) PacketRandom {
    std::uint32_t u_bits[ReceiverPacket::kSize];  ///< bits of u, as Reservoir has them
};

/// The state of a Reservoir of groups at the end.
struct GroupChoice {
    float weight_sum = 0.0f;
    float numerator = 0.0f;
    std::uint32_t record = 0;
};

/// The choices of the receivers of a packet.
struct alignas(64) PacketChoice {
    float weight_sum[ReceiverPacket::kSize];
    float numerator[ReceiverPacket::kSize];
    std::uint32_t record[ReceiverPacket::kSize];
};

}  // namespace lightcull
