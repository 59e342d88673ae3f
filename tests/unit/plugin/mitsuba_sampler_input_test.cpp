#include <doctest/doctest.h>
#include <lightcull/light.h>
#include <lightcull/light_sampler.h>

#include <functional>
#include <vector>

#include "sampler/sampler_input.h"

using lightcull::float3;
using lightcull::Light;
using lightcull::ShadingPoint;
using mitsuba::culling::SamplerInput;

namespace {

SamplerInput input() {
    return {"culled", std::vector<Light>(3), std::vector<ShadingPoint>(3), 100};
}

void check_is_told(const std::function<void(SamplerInput&)>& change) {
    SamplerInput changed = input();
    change(changed);
    CHECK_FALSE(changed == input());
    CHECK_FALSE(input() == changed);
}

void check_vector_is_told(const std::function<float3&(SamplerInput&)>& vector) {
    check_is_told([&](SamplerInput& in) { vector(in).x += 1.0f; });
    check_is_told([&](SamplerInput& in) { vector(in).y += 1.0f; });
    check_is_told([&](SamplerInput& in) { vector(in).z += 1.0f; });
}

}  // namespace

TEST_CASE("the Mitsuba plugin makes a new sampler where any member of a light differs") {
    CHECK(input() == input());
    check_vector_is_told([](SamplerInput& in) -> float3& { return in.lights[1].center; });
    check_vector_is_told([](SamplerInput& in) -> float3& { return in.lights[1].axis; });
    check_is_told([](SamplerInput& in) { in.lights[1].radius = 0.5f; });
    check_is_told([](SamplerInput& in) { in.lights[1].cos_theta_o = 0.5f; });
    check_is_told([](SamplerInput& in) { in.lights[1].cos_theta_e = 0.5f; });
    check_is_told([](SamplerInput& in) { in.lights[1].intensity = 0.5f; });
    check_is_told([](SamplerInput& in) { in.lights[1].two_sided = true; });
    check_is_told([](SamplerInput& in) { in.lights[1].lobe_alpha = 0.5f; });
    check_is_told([](SamplerInput& in) { in.lights.pop_back(); });
}

TEST_CASE(
    "the Mitsuba plugin makes a new sampler where anything else that it is made from differs") {
    check_vector_is_told([](SamplerInput& in) -> float3& { return in.points[1].position; });
    check_vector_is_told([](SamplerInput& in) -> float3& { return in.points[1].normal; });
    check_vector_is_told([](SamplerInput& in) -> float3& { return in.points[1].lobe.axis; });
    check_is_told([](SamplerInput& in) { in.points[1].set = 5; });
    check_is_told([](SamplerInput& in) { in.points[1].diffuse = 0.5f; });
    check_is_told([](SamplerInput& in) { in.points[1].lobe.alpha = 0.5f; });
    check_is_told([](SamplerInput& in) { in.points[1].lobe.peak = 0.5f; });
    check_is_told([](SamplerInput& in) { in.points.pop_back(); });
    check_is_told([](SamplerInput& in) { in.points_per_pass = 99; });
    check_is_told([](SamplerInput& in) { in.description = "power"; });
}
