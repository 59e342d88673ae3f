#pragma once

#include <cstddef>
#include <cstdint>

#include "base/float3_math.h"
#include "lights/light/receiver.h"

namespace lightcull {

/// Sixteen receivers of one set side by side; the names are those of Receiver.
struct alignas(64) ReceiverPacket {
    static constexpr std::size_t kSize = 16;

    float position[3][kSize];
    float normal[3][kSize];
    float from_all_sides[kSize], horizon[kSize];
    // Members of the glossy lobes; not read unless there are any.
    float diffuse[kSize];
    float axis[3][kSize];
    float alpha2[kSize], peak[kSize];

    float3 low, high;  ///< corners of a box around the positions
    std::uint32_t set;
    bool has_lobes;

    explicit ReceiverPacket(std::uint32_t s) noexcept : set(s), has_lobes(false) {}

    /// Puts a receiver into place i. Places are filled in their order, and all of them.
    void put(std::size_t i, const Receiver& receiver) noexcept {
        low = i == 0 ? receiver.position : min(low, receiver.position);
        high = i == 0 ? receiver.position : max(high, receiver.position);
        put(position, i, receiver.position);
        put(normal, i, receiver.normal);
        from_all_sides[i] = receiver.from_all_sides;
        horizon[i] = receiver.horizon;
        has_lobes |= receiver.has_lobe();
        diffuse[i] = receiver.diffuse;
        put(axis, i, receiver.axis);
        alpha2[i] = receiver.alpha2;
        peak[i] = receiver.peak;
    }

    bool has_lobe() const noexcept { return has_lobes; }

  private:
    static void put(float (&of)[3][kSize], std::size_t i, float3 value) noexcept {
        of[0][i] = value.x;
        of[1][i] = value.y;
        of[2][i] = value.z;
    }
};

}  // namespace lightcull
