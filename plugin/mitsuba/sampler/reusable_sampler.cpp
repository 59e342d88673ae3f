#include "sampler/reusable_sampler.h"

#include <lightcull/samplers.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace mitsuba::culling {
namespace {

using ::lightcull::float3;
using ::lightcull::Light;
using ::lightcull::ShadingPoint;

auto fields(const float3& v) {
    return std::tuple(v.x, v.y, v.z);
}

bool equal_lights(const Light& a, const Light& b) {
    const auto of = [](const Light& light) {
        return std::tuple_cat(fields(light.center), fields(light.axis),
                              std::tuple(light.radius, light.cos_theta_o, light.cos_theta_e,
                                         light.intensity, light.two_sided));
    };
    return of(a) == of(b);
}

/// As far as samplers are calibrated by them.
bool equal_points(const ShadingPoint& a, const ShadingPoint& b) {
    const auto of = [](const ShadingPoint& point) {
        return std::tuple_cat(fields(point.position), fields(point.normal));
    };
    return of(a) == of(b);
}

}  // namespace

bool operator==(const SamplerInput& a, const SamplerInput& b) {
    return a.description == b.description && a.points_per_pass == b.points_per_pass &&
           std::equal(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(),
                      equal_points) &&
           std::equal(a.lights.begin(), a.lights.end(), b.lights.begin(), b.lights.end(),
                      equal_lights);
}

MadeSampler::MadeSampler(SamplerInput input)
    : input_(std::move(input)),
      sampler_(::lightcull::make_sampler(input_.description, input_.lights,
                                         {input_.points, input_.points_per_pass})) {
}

}  // namespace mitsuba::culling
