#include "render/camera.h"

#include "render/warp.h"

#include <cmath>

namespace lightcull {

CameraRays::CameraRays(const Camera& camera, std::uint32_t width, std::uint32_t height) noexcept
    : origin_(to_v3f(camera.origin)),
      forward_(direction(to_float3(to_v3f(camera.target) - origin_))),
      aperture_radius_(camera.aperture_radius),
      focus_distance_(camera.focus_distance),
      orthographic_(camera.orthographic_height > 0.0f) {
    right_ = unit(forward_.cross(direction(camera.up)));
    up_ = right_.cross(forward_);
    const float half_height =
        orthographic_ ? 0.5f * camera.orthographic_height : std::tan(0.5f * camera.vertical_fov);
    const float pixel = 2.0f * half_height / static_cast<float>(height);
    const float half_width = 0.5f * pixel * static_cast<float>(width);
    corner_ = up_ * half_height - right_ * half_width;
    if (!orthographic_) corner_ += forward_;
    across_ = right_ * pixel;
    down_ = -up_ * pixel;
}

Ray CameraRays::ray(const V2f& place, const V2f& lens) const noexcept {
    const V3f through = corner_ + across_ * place.x + down_ * place.y;
    if (orthographic_) return {origin_ + through, forward_};
    // Its component along the axis is 1.
    if (!has_lens()) return {origin_, unit(through)};
    const V2f p = uniform_disk(lens) * aperture_radius_;
    const V3f offset = right_ * p.x + up_ * p.y;
    return {origin_ + offset, unit(through * focus_distance_ - offset)};
}

V3f CameraRays::to_view(const V3f& v) const noexcept {
    return {v.dot(right_), v.dot(up_), v.dot(up_.cross(right_))};
}

}  // namespace lightcull
