#pragma once

#include "base/core_export.h"
#include "render/vec.h"

namespace lightcull {

/// A triangle as it is seen from a point: its projection onto the unit sphere about it. In double
/// precision, as the angles of narrow ones are small differences.
class LIGHTCULL_CORE_EXPORT SphericalTriangle {
  public:
    /// The corners are relative to the point, and none of them is 0.
    SphericalTriangle(const V3d& a, const V3d& b, const V3d& c) noexcept;

    /// The solid angle, steradian, up to 2 pi (van Oosterom and Strackee 1983, Eq. 8); 0 seen
    /// edge-on.
    double solid_angle() const noexcept { return solid_angle_; }

    /// A direction uniform over the solid angle, of which there must be some (Arvo 1995,
    /// "Stratified sampling of spherical triangles", section 3, in the form of Peters 2021, "BRDF
    /// importance sampling for polygonal lights", section 4, which has hardly any angles).
    V3d sample(const V2f& u) const noexcept;

  private:
    V3d a_, b_, c_;  ///< directions of the corners, unit length
    double volume_;  ///< of the parallelepiped that they span
    double solid_angle_;
};

}  // namespace lightcull
