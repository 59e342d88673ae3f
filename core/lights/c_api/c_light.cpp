#include "lights/c_api/c_light.h"

#include <lightcull/error.h>

#include <cstddef>
#include <initializer_list>
#include <string>

#include "lights/c_api/c_error.h"

namespace lightcull {
namespace {

float3 to_float3(const float v[3]) noexcept {
    return {v[0], v[1], v[2]};
}

void to_array(float3 from, float (&to)[3]) noexcept {
    to[0] = from.x;
    to[1] = from.y;
    to[2] = from.z;
}

/// The size of the struct before it had the field `directional`, which is its last.
constexpr std::size_t kFirstSize = offsetof(lightcull_light, directional);

/// Structs of that size go by pointer: a reference says that all of the struct is there.
bool has_directional(const lightcull_light* light) noexcept {
    return light->size == sizeof(lightcull_light);
}

/// Throws Error for a wrong size. name: the name of the light in messages.
void check_size(const lightcull_light* light, const std::string& name) {
    if (has_directional(light) || light->size == kFirstSize) return;
    throw Error(name + ": size is " + std::to_string(light->size) + ", wanted " +
                std::to_string(sizeof(lightcull_light)) + ", sizeof(lightcull_light)");
}

Light to_cpp(const lightcull_light* from) noexcept {
    Light light;
    light.center = to_float3(from->center);
    light.radius = from->radius;
    light.axis = to_float3(from->axis);
    light.cos_theta_o = from->cos_theta_o;
    light.cos_theta_e = from->cos_theta_e;
    light.intensity = from->intensity;
    light.two_sided = from->two_sided != 0;
    light.lobe_alpha = from->lobe_alpha;
    light.directional = has_directional(from) && from->directional != 0;
    return light;
}

void to_c(const Light& from, lightcull_light* light) noexcept {
    to_array(from.center, light->center);
    light->radius = from.radius;
    to_array(from.axis, light->axis);
    light->cos_theta_o = from.cos_theta_o;
    light->cos_theta_e = from.cos_theta_e;
    light->intensity = from.intensity;
    light->two_sided = from.two_sided ? 1 : 0;
    light->lobe_alpha = from.lobe_alpha;
    if (has_directional(light)) light->directional = from.directional ? 1 : 0;
}

/// A vector that a host gives, with its name.
struct Given {
    const float* vector;
    const char* name;
};

/// Sets *light to what `make` gives, once the pointers are known to be none that are null.
template <typename Make>
lightcull_error set_light(lightcull_light* light, std::initializer_list<Given> vectors,
                          const Make& make) noexcept {
    return guarded([&] {
        for (const Given& given : vectors) check_not_null(given.vector, given.name);
        check_not_null(light, "light");
        check_size(light, "light");
        const Light made = make();
        if (made.directional && !has_directional(light)) {
            throw Error("light: size is " + std::to_string(light->size) +
                        ", that of a struct without the field directional");
        }
        to_c(made, light);
    });
}

}  // namespace

std::vector<Light> to_cpp(const lightcull_light* lights, std::size_t count) {
    if (count > 0) check_not_null(lights, "lights");
    std::vector<Light> all;
    all.reserve(count);
    if (count > 0) check_size(lights, "light 0");
    const auto* next = reinterpret_cast<const char*>(lights);
    for (std::size_t i = 0; i < count; ++i) {
        const auto* const light = reinterpret_cast<const lightcull_light*>(next);
        if (light->size != lights->size) {
            throw Error("light " + std::to_string(i) + ": size is " + std::to_string(light->size) +
                        ", and that of light 0 is " + std::to_string(lights->size));
        }
        all.push_back(to_cpp(light));
        next += lights->size;
    }
    return all;
}

}  // namespace lightcull

using namespace lightcull;

lightcull_error lightcull_triangle_light(const float a[3], const float b[3], const float c[3],
                                         float radiance, int two_sided, lightcull_light* light) {
    return set_light(light, {{a, "a"}, {b, "b"}, {c, "c"}}, [&] {
        return triangle_light(to_float3(a), to_float3(b), to_float3(c), radiance, two_sided != 0);
    });
}

lightcull_error lightcull_sphere_light(const float center[3], float radius, float radiance,
                                       lightcull_light* light) {
    return set_light(light, {{center, "center"}},
                     [&] { return sphere_light(to_float3(center), radius, radiance); });
}

lightcull_error lightcull_disc_light(const float center[3], const float normal[3], float radius,
                                     float radiance, int two_sided, lightcull_light* light) {
    return set_light(light, {{center, "center"}, {normal, "normal"}}, [&] {
        return disc_light(to_float3(center), to_float3(normal), radius, radiance, two_sided != 0);
    });
}

lightcull_error lightcull_cylinder_light(const float a[3], const float b[3], float radius,
                                         float radiance, lightcull_light* light) {
    return set_light(light, {{a, "a"}, {b, "b"}},
                     [&] { return cylinder_light(to_float3(a), to_float3(b), radius, radiance); });
}

lightcull_error lightcull_point_light(const float position[3], float intensity,
                                      lightcull_light* light) {
    return set_light(light, {{position, "position"}},
                     [&] { return point_light(to_float3(position), intensity); });
}

lightcull_error lightcull_spot_light(const float position[3], const float direction[3],
                                     float intensity, float inner, float outer,
                                     lightcull_light* light) {
    return set_light(light, {{position, "position"}, {direction, "direction"}}, [&] {
        return spot_light(to_float3(position), to_float3(direction), intensity, inner, outer);
    });
}

lightcull_error lightcull_diffuse_point_light(const float position[3], const float normal[3],
                                              float intensity, lightcull_light* light) {
    return set_light(light, {{position, "position"}, {normal, "normal"}}, [&] {
        return diffuse_point_light(to_float3(position), to_float3(normal), intensity);
    });
}

lightcull_error lightcull_glossy_point_light(const float position[3], const float direction[3],
                                             float intensity, float alpha, lightcull_light* light) {
    return set_light(light, {{position, "position"}, {direction, "direction"}}, [&] {
        return glossy_point_light(to_float3(position), to_float3(direction), intensity, alpha);
    });
}

lightcull_error lightcull_directional_light(const float direction[3], float irradiance,
                                            lightcull_light* light) {
    return set_light(light, {{direction, "direction"}},
                     [&] { return directional_light(to_float3(direction), irradiance); });
}

lightcull_error lightcull_bounded_light(const float box_min[3], const float box_max[3],
                                        const float axis[3], float cos_theta_o, float cos_theta_e,
                                        int two_sided, float power, lightcull_light* light) {
    return set_light(light, {{box_min, "box_min"}, {box_max, "box_max"}, {axis, "axis"}}, [&] {
        return bounded_light(to_float3(box_min), to_float3(box_max), to_float3(axis), cos_theta_o,
                             cos_theta_e, two_sided != 0, power);
    });
}
