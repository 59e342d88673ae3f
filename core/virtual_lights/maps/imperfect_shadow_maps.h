#pragma once

#include "virtual_lights/light/virtual_light.h"
#include "virtual_lights/maps/point_cloud.h"

#include <lightcull/span.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace lightcull {

/// A coarse shadow map of the hemisphere over each of many virtual lights, into which some points
/// of the scene are splatted (Ritschel et al. 2008; [TH16] section 4.3).
class ImperfectShadowMaps {
  public:
    /// The number of texels of a map along an edge: [TH16] section 4.4.
    static constexpr std::uint32_t kEdge = 32;
    static constexpr std::size_t kBytesPerLight = std::size_t{kEdge} * kEdge * sizeof(float);
    /// The largest number of lights. More would take too much memory: 4 KB each.
    static constexpr std::size_t kMostLights = std::size_t{1} << 18;

    /// Makes the maps. Each takes a part of the cloud, drawn at random, and of it the points that
    /// Program 1 of [TH16] keeps: the points that show the light their back (its own surface and
    /// those that it lights would else be dark by their own points), lie above its surface, and
    /// within its range, metres. Runs in the caller's TBB arena.
    ImperfectShadowMaps(const std::vector<VirtualLight>& lights, Span<const float> ranges,
                        const PointCloud& cloud, std::uint64_t key);

    /// True if anything in the map of light i lies before a place.
    bool occluded(std::size_t i, const VirtualLight& light, const V3f& place) const noexcept;

    /// The number of points that were splatted, into all maps.
    std::uint64_t splatted() const noexcept { return splatted_; }

  private:
    std::unique_ptr<float[]> depths_;  ///< distance to the nearest point, metres: [light][texel]
    std::uint64_t splatted_ = 0;
};

}  // namespace lightcull
