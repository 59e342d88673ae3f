#pragma once

#include "lights/ranges/ranges.h"
#include "virtual_lights/volumes/bounding_volume.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace lightcull {

/// Decides which virtual lights count at a point, and by how much more to make up for those that do
/// not: Russian roulette by [TH17] Eqs. 2 and 3, constant ranges, or all of them.
class Acceptance {
  public:
    /// ranges: those of the pass; not used by kAll.
    Acceptance(VirtualLightMethod method, const RandomRanges& ranges)
        : method_(method), ranges_(ranges) {}

    /// The numbers of a light that do not depend on the point.
    struct OfLight {
        float inverse_xi;
        float limit;  ///< square of its range, for kClamped
    };
    OfLight of_light(const VirtualLight& light, std::uint32_t index) const noexcept {
        return {1.0f / ranges_.xi(index, 0), ranges_.limit(intensity_bound(light))};
    }

    /// True if some lights count only at some points.
    bool has_ranges() const noexcept {
        return method_ == VirtualLightMethod::kCulled || method_ == VirtualLightMethod::kClamped;
    }

    /// A volume that encloses the points where the light counts, if has_ranges().
    Spheroid volume(const VirtualLight& light, const OfLight& of_light,
                    BoundingVolume kind) const noexcept {
        if (method_ == VirtualLightMethod::kClamped) kind = BoundingVolume::kSphereAtLight;
        return bounding_volume(light, ranges_.reach() * of_light.inverse_xi, kind);
    }

    /// The square of a distance from the light beyond which it does not count.
    float farthest2(const VirtualLight& light, const OfLight& of_light) const noexcept {
        if (!has_ranges()) return std::numeric_limits<float>::infinity();
        const float range = volume(light, of_light, BoundingVolume::kSphereAtLight).radius;
        return range * range;
    }

    /// The factor 1 / p where the light counts, else 0. intensity: towards the point, by luminance,
    /// above 0.
    float weight(const OfLight& light, float intensity, float distance) const noexcept {
        switch (method_) {
            case VirtualLightMethod::kClamped:
                return distance * distance <= light.limit ? 1.0f : 0.0f;
            case VirtualLightMethod::kCulled:
                return distance * distance <= ranges_.limit(intensity) * light.inverse_xi
                           ? ranges_.inverse_prob(intensity, distance)
                           : 0.0f;
            case VirtualLightMethod::kAll:
            case VirtualLightMethod::kGrid:
                break;
        }
        return 1.0f;
    }

  private:
    VirtualLightMethod method_;
    const RandomRanges& ranges_;
};

}  // namespace lightcull
