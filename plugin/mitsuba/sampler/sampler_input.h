#pragma once

#include <lightcull/light.h>
#include <lightcull/light_sampler.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

namespace mitsuba::culling {

/// All that a light sampler is made from.
struct SamplerInput {
    std::string description;
    std::vector<::lightcull::Light> lights;
    std::vector<::lightcull::ShadingPoint> points;  ///< to calibrate on
    std::uint32_t points_per_pass = 0;              ///< camera points
};

// The members of each record that equality depends on. A structured binding names every member, so
// that a member added to a record does not compile until it is named here.

inline auto members(const ::lightcull::float3& v) {
    const auto& [x, y, z] = v;
    return std::tuple(x, y, z);
}

inline auto members(const ::lightcull::Light& light) {
    const auto& [center, radius, axis, cos_theta_o, cos_theta_e, intensity, two_sided, lobe_alpha,
                 directional] = light;
    return std::tuple_cat(members(center), members(axis),
                          std::tuple(radius, cos_theta_o, cos_theta_e, intensity, two_sided,
                                     lobe_alpha, directional));
}

inline auto members(const ::lightcull::GlossyLobe& lobe) {
    const auto& [axis, alpha, peak] = lobe;
    return std::tuple_cat(members(axis), std::tuple(alpha, peak));
}

inline auto members(const ::lightcull::ShadingPoint& point) {
    const auto& [position, normal, set, diffuse, lobe] = point;
    return std::tuple_cat(members(position), members(normal), std::tuple(set, diffuse),
                          members(lobe));
}

/// Whether two lists hold equal records in the same order.
template <typename Record>
bool equal_records(const std::vector<Record>& a, const std::vector<Record>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const Record& x, const Record& y) { return members(x) == members(y); });
}

inline bool operator==(const SamplerInput& a, const SamplerInput& b) {
    return a.description == b.description && a.points_per_pass == b.points_per_pass &&
           equal_records(a.points, b.points) && equal_records(a.lights, b.lights);
}

}  // namespace mitsuba::culling
