#pragma once

#include "base/core_export.h"
#include "render/ray.h"
#include "render/vec.h"

#include <lightcull/render/scene.h>

#include <cstdint>

namespace lightcull {

/// Rays of a thin-lens camera, or of a pinhole where the aperture is 0. What lies in the plane
/// `focus_distance` in front of the lens is sharp. Those of an orthographic camera are parallel.
class LIGHTCULL_CORE_EXPORT CameraRays {
  public:
    /// width, height: pixels of the image.
    CameraRays(const Camera& camera, std::uint32_t width, std::uint32_t height) noexcept;

    /// The ray for a place on the image in pixels, (0, 0) being its upper left corner, and two
    /// uniform numbers that choose a place on the lens.
    Ray ray(const V2f& place, const V2f& lens) const noexcept;

    /// False if it does not matter which place on the lens is chosen.
    bool has_lens() const noexcept { return aperture_radius_ > 0.0f && !orthographic_; }

    /// The components of a vector to the right, up, and forward.
    V3f to_view(const V3f& v) const noexcept;
    /// The middle of the lens, or of the plane where orthographic rays start.
    const V3f& origin() const noexcept { return origin_; }

  private:
    V3f origin_, forward_, right_, up_, corner_, across_, down_;
    float aperture_radius_, focus_distance_;
    bool orthographic_;
};

}  // namespace lightcull
