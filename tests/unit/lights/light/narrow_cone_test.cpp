#include <doctest/doctest.h>
#include <lightcull/light.h>
#include <lightcull/samplers.h>

#include <cmath>
#include <string>
#include <vector>

#include "lights/bvh/light_bvh_cluster.h"
#include "lights/light/importance.h"
#include "unit/test_lights.h"

/// These tests show that cones which a cosine in single precision does not tell apart, and spots
/// with a hard edge, are reached by every sampler.

using namespace lightcull;
using namespace lightcull::testing;

namespace {

/// Half-angles of spots, in radians: the least are a few millionths of a degree.
constexpr float kOuter[] = {1e-7f, 4e-5f, 1.7e-4f, 3.5e-4f, 1e-3f, 3e-3f, 0.02f, 0.5f, 1.5f, 3.0f};
/// The inner angles that go with each of them, in parts of it.
constexpr float kInner[] = {0.0f, 0.8f, 0.9999f, 1.0f};

float3 any_across(float3 axis, RandomStream& random) {
    const float3 side = cross(axis, random_direction(random));
    return side * (1.0f / length(side));
}

/// A point in a volume at an angle to the axis of a light.
ShadingPoint seen_under(const Light& light, float angle, float distance, RandomStream& random) {
    const float3 way =
        light.axis * std::cos(angle) + any_across(light.axis, random) * std::sin(angle);
    return {light.center + way * distance, {0, 0, 0}, 0};
}

float importance_of(const Light& light, const ShadingPoint& point) {
    const Light lights[] = {light};
    const LightTable table = make_light_table(lights);
    const Receiver receiver(table.frame, point);
    return importance(table.records[0], approach(receiver.position, table.records[0].center),
                      receiver);
}

std::vector<Light> spots(float inner, float outer, RandomStream& random) {
    std::vector<Light> lights;
    for (int i = 0; i < 24; ++i) {
        // Some of them are parallel.
        const float3 axis = i % 3 == 0 ? float3{0.6f, 0, -0.8f} : random_direction(random);
        lights.push_back(spot_light(random_in_box(random, 1), axis, 1.0f, inner, outer));
    }
    return lights;
}

}  // namespace

TEST_CASE("every sampler may choose a spot wherever in its cone a point lies") {
    const char* const descriptions[] = {"uniform", "power", "exhaustive", "light_bvh",
                                        "light_bvh:importance=means", "culled", "culled:group=1",
                                        "learned", "paper", "paper:weight=g_over_p:list=0",
                                        // So long are the ranges that no light is out of them.
                                        "clamped:error_bound=1e-9"};
    for (const bool with_glossy : {false, true}) {
        for (const float outer : kOuter) {
            for (const float part : kInner) {
                RandomStream random(1);
                std::vector<Light> lights = spots(part * outer, outer, random);
                if (with_glossy) {
                    lights.push_back(glossy_point_light({1, 1, 1}, {0, 0, 1}, 1e-6f, 0.1f));
                }
                for (const std::string description : descriptions) {
                    CAPTURE(description);
                    CAPTURE(outer);
                    CAPTURE(part);
                    // No more than importance is needed to see what the others see.
                    if (with_glossy && description != "culled") continue;
                    const auto sampler = make_sampler(description, lights);
                    sampler->begin_pass(1);
                    for (std::uint32_t i = 0; i < 24; ++i) {
                        for (const float at : {0.0f, 0.3f, 0.9f, 0.999f}) {
                            const ShadingPoint point = seen_under(
                                lights[i], at * outer, 0.1f + 2.0f * random.next(), random);
                            const Receipt receipt = sampler->select(point, 0.5f).receipt;
                            REQUIRE(sampler->prob(point, receipt, i) > 0.0f);
                        }
                    }
                }
            }
        }
    }
}

TEST_CASE("importance knows cones far narrower than a degree") {
    RandomStream random(2);
    for (const float outer : {4e-5f, 1.7e-4f, 3.5e-4f, 1e-3f, 3e-3f, 0.02f, 0.5f}) {
        for (const float part : kInner) {
            const Light spot =
                spot_light({1, 2, 3}, random_direction(random), 1.0f, part * outer, outer);
            CAPTURE(outer);
            CAPTURE(part);
            // The margin is for the rounding of the axis and of both cosines.
            constexpr float kMargin = 8e-4f;
            CHECK(importance_of(spot, seen_under(spot, 0.99f * outer, 1, random)) > 0.0f);
            CHECK(importance_of(spot, seen_under(spot, 1.01f * outer + kMargin, 1, random)) ==
                  0.0f);
        }
    }
}

TEST_CASE("a cone about the normals of a light with extent is one of its whole sphere") {
    RandomStream random(3);
    const float cosine = std::cos(1e-3f);
    for (const bool two_sided : {false, true}) {
        const Light light = bounded_light({-0.01f, -0.01f, -0.01f}, {0.01f, 0.01f, 0.01f},
                                          {0, 0, 1}, cosine, 1.0f, two_sided, 1.0f);
        // The sphere of radius 0.0173 fills that angle at a distance of 1.
        CHECK(importance_of(light, seen_under(light, 1e-3f + 0.0173f, 1, random)) > 0.0f);
        CHECK(importance_of(light, seen_under(light, 1e-3f + 0.0190f, 1, random)) == 0.0f);
        CHECK((importance_of(light, seen_under(light, 3.14159f, 1, random)) > 0.0f) == two_sided);
    }
}

TEST_CASE("narrow cones merge into one that holds both") {
    RandomStream random(4);
    for (int i = 0; i < 20000; ++i) {
        const float size = std::exp2(-16.0f * random.next());
        EmissionCone a, b;
        a.axis = random_direction(random);
        b.axis = a.axis * std::cos(size * 2) + any_across(a.axis, random) * std::sin(size * 2);
        b.axis = b.axis * (1.0f / length(b.axis));
        a.set_theta_o(size * random.next());
        b.set_theta_o(3.0f * size * random.next());
        const EmissionCone both = merge(a, b);
        for (const EmissionCone& one : {a, b}) {
            const float between =
                std::atan2(length(cross(both.axis, one.axis)), dot(both.axis, one.axis));
            // Rounding moves axes by some 1e-7.
            REQUIRE(between + one.theta_o <= both.theta_o + 1e-6f);
        }
    }
}

TEST_CASE("the power of a narrow cone is that of its solid angle") {
    constexpr double kPi = 3.14159265358979;
    for (const double theta : {1e-4, 1e-3, 1e-2}) {
        EmissionCone hard;
        hard.set_theta_o(static_cast<float>(theta));
        CHECK(orientation_measure(hard) == doctest::Approx(kPi * theta * theta).epsilon(1e-4));
        EmissionCone soft;
        soft.theta_e = static_cast<float>(theta);
        CHECK(orientation_measure(soft) == doctest::Approx(kPi * theta * theta).epsilon(1e-4));
    }
}
