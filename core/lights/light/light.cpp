#include <lightcull/light.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/float3_math.h"

namespace lightcull {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// The length of a vector whose square may be too large or too small for a float.
float norm(float3 v) noexcept {
    return std::hypot(v.x, v.y, v.z);
}

float largest_component(float3 v) noexcept {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

float3 unit(float3 v) noexcept {
    const float largest = largest_component(v);
    if (!(largest > 0.0f)) return {0, 0, 0};
    const float3 scaled{v.x / largest, v.y / largest, v.z / largest};
    return scaled * (1.0f / length(scaled));
}

/// An intensity as a float. What emits keeps some, however faint it is: a light of none is never
/// chosen.
float peak(double intensity) noexcept {
    constexpr double kLeast = std::numeric_limits<float>::min();
    return static_cast<float>(intensity > 0.0 ? std::max(intensity, kLeast) : intensity);
}

/// Two edges of a triangle in parts of `size`, their largest component: no power of them overflows
/// or is rounded to 0.
struct Edges {
    float size;
    float3 ab, ac;

    Edges(float3 a, float3 b, float3 c) noexcept
        : size(std::max(largest_component(b - a), largest_component(c - a))) {
        if (!(size > 0.0f)) return;
        const float3 b_a = b - a, c_a = c - a;
        ab = {b_a.x / size, b_a.y / size, b_a.z / size};
        ac = {c_a.x / size, c_a.y / size, c_a.z / size};
    }
};

/// Sets the smallest sphere around a triangle: that of its longest edge if the triangle is obtuse,
/// else the circumscribed one.
void set_bounding_sphere(Light& light, const Edges& edges, float3 a, float3 b, float3 c) noexcept {
    const float3 ab = edges.ab, ac = edges.ac, bc = ac - ab;
    const float3 normal = cross(ab, ac);
    const float normal2 = dot(normal, normal);
    const float ab2 = dot(ab, ab), ac2 = dot(ac, ac), bc2 = dot(bc, bc);
    const bool acute = ab2 + ac2 > bc2 && ab2 + bc2 > ac2 && ac2 + bc2 > ab2;
    float3 center = ab * 0.5f;  // from a, in parts of edges.size
    if (acute && normal2 > 0.0f) {
        center = (cross(normal, ab) * ac2 + cross(ac, normal) * ab2) * (0.5f / normal2);
    } else if (bc2 > ab2 && bc2 > ac2) {
        center = ab + bc * 0.5f;
    } else if (ac2 > ab2) {
        center = ac * 0.5f;
    }
    light.center = a + center * edges.size;
    // The radius is measured from the centre that was found, whatever rounding did to it.
    constexpr float kRoundUp = 1.0f + 1e-6f;
    light.radius =
        std::max({norm(a - light.center), norm(b - light.center), norm(c - light.center)}) *
        kRoundUp;
}

/// The integral over the sphere of the intensity of Light's profile, relative to its peak: 1 up to
/// theta_o from the axis, then cos(theta - theta_o) for theta_e more.
double profile_integral(double theta_o, double theta_e) noexcept {
    const double end = std::min(theta_o + theta_e, kPi);
    const double beyond = end - theta_o, half_sine = std::sin(0.5 * theta_o);
    // This is the integral of sin(t) cos(t - theta_o) = (sin(2 t - theta_o) + sin(theta_o)) / 2
    // from theta_o to end. No cosines are subtracted: those of narrow cones do not differ.
    const double tail = 0.5 * (std::sin(end) * std::sin(beyond) + std::sin(theta_o) * beyond);
    return 2.0 * kPi * (2.0 * half_sine * half_sine + tail);
}

}  // namespace

Light triangle_light(float3 a, float3 b, float3 c, float radiance, bool two_sided) noexcept {
    Light light;
    const Edges edges(a, b, c);
    set_bounding_sphere(light, edges, a, b, c);
    const float3 normal = cross(edges.ab, edges.ac);
    const float3 axis = unit(normal);
    const bool has_area = axis.x != 0.0f || axis.y != 0.0f || axis.z != 0.0f;
    if (has_area) light.axis = axis;
    light.cos_theta_o = 1.0f;
    const double size = edges.size;
    light.intensity =
        has_area ? peak(0.5 * double{radiance} * double{norm(normal)} * size * size) : 0.0f;
    light.two_sided = two_sided;
    return light;
}

Light sphere_light(float3 center, float radius, float radiance) noexcept {
    const double r = radius;
    Light light = point_light(center, peak(kPi * double{radiance} * r * r));
    light.radius = radius;
    return light;
}

Light disc_light(float3 center, float3 normal, float radius, float radiance,
                 bool two_sided) noexcept {
    Light light = sphere_light(center, radius, radiance);
    light.axis = unit(normal);
    light.cos_theta_o = 1.0f;
    light.two_sided = two_sided;
    return light;
}

Light cylinder_light(float3 a, float3 b, float radius, float radiance) noexcept {
    const float3 half = (b - a) * 0.5f;
    const float half_length = norm(half);
    Light light =
        point_light(a + half, peak(4.0 * double{radiance} * double{radius} * double{half_length}));
    light.radius = std::hypot(half_length, radius) * (1.0f + 1e-6f);
    return light;
}

Light point_light(float3 position, float intensity) noexcept {
    Light light;
    light.center = position;
    light.intensity = intensity;
    return light;
}

Light spot_light(float3 position, float3 direction, float intensity, float inner,
                 float outer) noexcept {
    Light light = point_light(position, intensity);
    light.axis = unit(direction);
    light.cos_theta_o = std::min(std::cos(inner), std::nextafter(1.0f, 0.0f));  // not flat
    // Beyond 90 degrees a cosine is no bound any more; there the whole fall-off counts as full.
    const float fall_off = outer - inner;
    if (fall_off >= static_cast<float>(kPi / 2)) light.cos_theta_o = std::cos(outer);
    light.cos_theta_e = std::max(0.0f, std::cos(fall_off));
    return light;
}

Light diffuse_point_light(float3 position, float3 normal, float intensity) noexcept {
    Light light = point_light(position, intensity);
    light.axis = normal;
    light.cos_theta_o = 1.0f;
    return light;
}

Light glossy_point_light(float3 position, float3 direction, float intensity, float alpha) noexcept {
    Light light = point_light(position, intensity);
    light.axis = direction;
    light.lobe_alpha = alpha;
    return light;
}

Light directional_light(float3 direction, float irradiance) noexcept {
    Light light = point_light({0, 0, 0}, irradiance);
    light.axis = unit(direction);
    light.directional = true;
    return light;
}

Light bounded_light(float3 box_min, float3 box_max, float3 axis, float cos_theta_o,
                    float cos_theta_e, bool two_sided, float power) noexcept {
    Light light;
    light.center = box_min * 0.5f + box_max * 0.5f;
    light.radius = norm(box_max - light.center) * (1.0f + 1e-6f);
    light.axis = axis;
    // The box does not say where the plane of a flat light lies.
    light.cos_theta_o = cos_theta_o == 1.0f ? std::nextafter(1.0f, 0.0f) : cos_theta_o;
    light.cos_theta_e = cos_theta_e;
    light.two_sided = two_sided;
    const double solid_angle =
        profile_integral(std::acos(std::clamp(static_cast<double>(cos_theta_o), -1.0, 1.0)),
                         std::acos(std::clamp(static_cast<double>(cos_theta_e), -1.0, 1.0)));
    light.intensity = peak(power / (solid_angle * (two_sided ? 2.0 : 1.0)));
    return light;
}

}  // namespace lightcull
