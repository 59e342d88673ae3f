#pragma once

#include "render/vec.h"
#include "virtual_lights/light/virtual_light.h"

#include <lightcull/virtual_lights/virtual_light_renderer.h>

namespace lightcull {

/// A spheroid with rotational symmetry about `axis`; a sphere where half_length equals radius.
struct Spheroid {
    V3f center;
    V3f axis;           ///< unit length
    float half_length;  ///< half of its length along the axis, metres
    float radius;       ///< radius across the axis, metres; half_length at most
};

/// The direction into which a perfect mirror in place of the light's surface would send the light.
V3f mirrored(const VirtualLight& light) noexcept;

/// A bound on the intensity in any direction, W/sr by luminance.
float intensity_bound(const VirtualLight& light) noexcept;

/// The volume that encloses every place at which scale * intensity(direction to it) reaches
/// distance^2, intensity by luminance; scale: m^2 sr / W, which for random ranges is reach / xi
/// ([TH17] Eq. 5).
Spheroid bounding_volume(const VirtualLight& light, float scale, BoundingVolume kind) noexcept;

}  // namespace lightcull
