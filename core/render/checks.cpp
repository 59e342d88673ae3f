#include "render/checks.h"

#include "render/vec.h"

#include <lightcull/error.h>

#include <cmath>
#include <limits>

namespace lightcull::check {

void fail(std::string_view what, const std::string& why) {
    throw Error(std::string(what) + " " + why);
}

void finite(std::string_view what, float value) {
    if (!std::isfinite(value)) fail(what, "is not finite");
}

void finite(std::string_view what, float2 value) {
    if (!std::isfinite(value.x) || !std::isfinite(value.y)) fail(what, "is not finite");
}

void finite(std::string_view what, float3 value) {
    if (!is_finite(to_v3f(value))) fail(what, "is not finite");
}

bool is_position(float3 value) noexcept {
    constexpr float kLargestCoordinate = 1e15f;
    return std::fabs(value.x) <= kLargestCoordinate && std::fabs(value.y) <= kLargestCoordinate &&
           std::fabs(value.z) <= kLargestCoordinate;
}

void position(std::string_view what, float3 value) {
    finite(what, value);
    if (!is_position(value)) fail(what, "is above 1e15");
}

void positions(std::string_view what, Span<const float3> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!is_position(values[i])) position(element(what, i), values[i]);
    }
}

void radiometric(std::string_view what, float3 value) {
    finite(what, value);
    if (value.x < 0.0f || value.y < 0.0f || value.z < 0.0f) fail(what, "is negative");
}

void in_unit_range(std::string_view what, float value) {
    if (!(value >= 0.0f && value <= 1.0f)) {
        fail(what, "is " + std::to_string(value) + ", not in [0, 1]");
    }
}

void index(std::string_view what, std::size_t i, std::size_t count, std::string_view kind) {
    if (i >= count) {
        fail(what, "is " + std::to_string(i) + ", but there are " + std::to_string(count) + " " +
                       std::string(kind));
    }
}

void emissive_area(std::string_view mesh, std::size_t i, float3 a, float3 b, float3 c) {
    // What is far above is found in floats, which is quicker.
    constexpr float kSurely = 1e-15f;
    const V3f normal = (to_v3f(b) - to_v3f(a)).cross(to_v3f(c) - to_v3f(a));
    if (std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z) > kSurely) return;
    constexpr double kLeast = std::numeric_limits<float>::min();
    const Imath::V3d corner(to_v3f(a));
    const double twice =
        (Imath::V3d(to_v3f(b)) - corner).cross(Imath::V3d(to_v3f(c)) - corner).length();
    if (!(twice > 0.0 && twice < kLeast)) return;
    fail(std::string(mesh) + ": triangle " + std::to_string(i),
         "emits, and its area is below 6e-39 m^2, which floats do not hold");
}

void texture(std::string_view what, const Texture& texture) {
    const std::size_t count = std::size_t{texture.width} * texture.height;
    if (count == 0) fail(what, "has no texels");
    const std::size_t encoded = texture.texels8.size() + texture.texels16.size();
    const std::size_t channels = encoded == 0 ? 1 : texture.channels;
    if (channels != 1 && channels != 3) fail(what, "has neither 1 nor 3 channels");
    const std::size_t given = texture.texels.size() + encoded;
    if (given != count * channels) {
        fail(what, "has " + std::to_string(given / channels) + " texels, not " +
                       std::to_string(texture.width) + " x " + std::to_string(texture.height));
    }
    const bool has_two = texture.texels.size() != given && texture.texels8.size() != given &&
                         texture.texels16.size() != given;
    if (has_two) fail(what, "has texels of two kinds");
    for (std::size_t i = 0; i < texture.texels.size(); ++i) {
        const float3 texel = texture.texels[i];
        if (!is_finite(to_v3f(texel)) || texel.x < 0.0f || texel.y < 0.0f || texel.z < 0.0f) {
            radiometric(std::string(what) + ": " + element("texels", i), texel);
        }
    }
}

void camera(const Camera& camera) {
    position("camera: origin", camera.origin);
    position("camera: target", camera.target);
    finite("camera: up", camera.up);
    const V3f forward = to_v3f(camera.target) - to_v3f(camera.origin);
    if (!(forward.length() > 0.0f)) fail("camera: target", "is the origin");
    const V3f up = direction(camera.up);
    if (!(up.length() > 0.0f)) fail("camera: up", "is 0");
    if (forward.normalized().cross(up).length() < 1e-4f) {
        fail("camera: up", "is parallel to the direction of view");
    }
    if (!(camera.vertical_fov > 0.0f && camera.vertical_fov < kPi)) {
        fail("camera: vertical_fov", "is not in (0, pi)");
    }
    finite("camera: aperture_radius", camera.aperture_radius);
    if (camera.aperture_radius > 1e15f) fail("camera: aperture_radius", "is above 1e15");
    if (camera.aperture_radius < 0.0f) fail("camera: aperture_radius", "is negative");
    finite("camera: focus_distance", camera.focus_distance);
    if (camera.focus_distance <= 0.0f) fail("camera: focus_distance", "is not above 0");
    if (camera.focus_distance > 1e15f) fail("camera: focus_distance", "is above 1e15");
    finite("camera: orthographic_height", camera.orthographic_height);
    if (camera.orthographic_height > 1e15f) fail("camera: orthographic_height", "is above 1e15");
    if (camera.orthographic_height < 0.0f) fail("camera: orthographic_height", "is negative");
    if (camera.orthographic_height > 0.0f && camera.aperture_radius > 0.0f) {
        fail("camera: aperture_radius", "is above 0, and orthographic cameras have no lens");
    }
}

std::string element(std::string_view field, std::size_t i) {
    return std::string(field) + "[" + std::to_string(i) + "]";
}

}  // namespace lightcull::check
