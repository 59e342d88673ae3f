#pragma once

#include "render/camera.h"
#include "render/vec.h"
#include "virtual_lights/volumes/bounding_volume.h"
#include "virtual_lights/volumes/box_tree.h"

#include <lightcull/span.h>

#include <array>

namespace lightcull {

/// The part of a tile's frustum that holds some points, in view space.
struct FrustumPiece {
    V3f low{0.0f}, high{0.0f};                  ///< box around the points
    V2f tangent_low{0.0f}, tangent_high{0.0f};  ///< bounds of x / z and y / z of the points
    bool empty = true;

    void add(const V3f& point) noexcept;
    AlignedBox box() const noexcept { return {low, high}; }
};

/// The points of a tile in two clusters of depth (modified half-Z: Stewart 2015; [TH17] section
/// 5.1), which are cut in the middle and then drawn together around their points.
class TileBounds {
  public:
    /// points: in view space, in front of the camera.
    explicit TileBounds(Span<const V3f> points) noexcept;

    static constexpr std::uint32_t kClusters = 2;
    std::uint32_t cluster_of(const V3f& point) const noexcept { return point.z < split_ ? 0 : 1; }
    const FrustumPiece& piece(std::uint32_t cluster) const noexcept { return pieces_[cluster]; }

  private:
    float split_ = 0.0f;
    std::array<FrustumPiece, kClusters> pieces_;
};

/// The box in view space that encloses a volume.
AlignedBox box_in_view(const Spheroid& spheroid, const CameraRays& camera) noexcept;

/// A bounding volume in the form in which tiles are tested against it. A spheroid becomes the unit
/// sphere by stretching space, which is then turned until planes of equal depth are level again:
/// [TH17] Eqs. 16 and 17. There a box around the piece of the frustum is tested, after the sphere
/// about the spheroid has been tested against the box of the piece's points.
class VolumeInView {
  public:
    VolumeInView() = default;
    VolumeInView(const Spheroid& spheroid, const CameraRays& camera) noexcept;

    /// False only if no point of the piece lies in the volume.
    bool overlaps(const FrustumPiece& piece) const noexcept;

  private:
    bool sphere_overlaps(const FrustumPiece& piece) const noexcept;

    bool is_sphere_ = true;
    V3f center_{0.0f};
    float radius_ = 0.0f;  // radius of the sphere about it all
    V3f stretched_center_{0.0f};
    std::array<V3f, 3> matrix_;  // B S, by rows
};

}  // namespace lightcull
