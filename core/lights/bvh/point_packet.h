#pragma once

#include <cstddef>
#include <cstdint>

#include "base/float3_math.h"
#include "base/refine.h"
#include "lights/bvh/light_bvh_descend.h"

namespace lightcull {

/// Sixteen points of one set side by side, as LightBvhPoint has them.
struct alignas(64) PointPacket {
    static constexpr std::size_t kSize = 16;

    float x[kSize], y[kSize], z[kSize];
    float normal[3][kSize];
    float from_all_sides[kSize], horizon[kSize];
    std::uint32_t u_bits[kSize];
    // Of the receivers' glossy lobes; not read unless there are any.
    float diffuse[kSize];
    float lobe[3][kSize];  ///< axes
    float alpha2[kSize], peak[kSize];

    float3 low, high;  ///< of a box around the positions
    std::uint32_t set;
    bool has_lobes;
};

/// Fills a packet, point by point.
class PacketBuilder {
  public:
    explicit PacketBuilder(std::uint32_t set) noexcept {
        packet_.set = set;
        packet_.has_lobes = false;
    }

    /// At most PointPacket::kSize times.
    void add(const LightBvhPoint& point, float u) noexcept {
        const std::size_t i = size_++;
        const float3 x = point.position, n = point.normal;
        packet_.x[i] = x.x, packet_.y[i] = x.y, packet_.z[i] = x.z;
        packet_.low = i == 0 ? x : min(packet_.low, x);
        packet_.high = i == 0 ? x : max(packet_.high, x);
        packet_.normal[0][i] = n.x, packet_.normal[1][i] = n.y, packet_.normal[2][i] = n.z;
        packet_.from_all_sides[i] = point.from_all_sides;
        packet_.horizon[i] = point.horizon;
        packet_.u_bits[i] = float_bits(u);
        packet_.has_lobes |= point.peak > 0.0f;
        packet_.diffuse[i] = point.diffuse;
        packet_.lobe[0][i] = point.axis.x, packet_.lobe[1][i] = point.axis.y;
        packet_.lobe[2][i] = point.axis.z;
        packet_.alpha2[i] = point.alpha2, packet_.peak[i] = point.peak;
    }

    std::size_t size() const noexcept { return size_; }
    const PointPacket& packet() const noexcept { return packet_; }

  private:
    PointPacket packet_;
    std::size_t size_ = 0;
};

}  // namespace lightcull
