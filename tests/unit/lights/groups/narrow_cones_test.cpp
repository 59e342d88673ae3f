#include "lights/groups/narrow_cones.h"

#include <lightcull/light_sampler.h>
#include <lightcull/samplers.h>

#include <doctest/doctest.h>

#include <vector>

#include "base/random.h"

namespace lightcull {
namespace {

/// Spots over a stage, each of which lights a place of its own.
std::vector<Light> stage(std::size_t count, float angle) {
    std::vector<Light> lights;
    RandomStream random(3);
    for (std::size_t i = 0; i < count; ++i) {
        const float3 at{40.0f * random.next() - 20.0f, 10.0f, 40.0f * random.next() - 20.0f};
        const float3 towards{random.next() - 0.5f, -2.0f, random.next() - 0.5f};
        lights.push_back(spot_light(at, towards, 10.0f, 0.8f * angle, angle));
    }
    return lights;
}

/// The part of points that nothing is chosen for, of those that some light reaches.
double missed(const LightSampler& sampler, const LightSampler& exhaustive) {
    RandomStream random(5);
    double lit = 0.0, empty = 0.0;
    for (int i = 0; i < 2000; ++i) {
        const ShadingPoint point{
            {30.0f * random.next() - 15.0f, 0.0f, 30.0f * random.next() - 15.0f}, {0, 1, 0}, 0};
        if (!(exhaustive.select(point, 0.5f).prob > 0.0f)) continue;
        lit += 1.0;
        empty += sampler.select(point, random.next()).prob > 0.0f ? 0.0 : 1.0;
    }
    return empty / lit;
}

}  // namespace

TEST_CASE("narrow cones are told from wide ones, from points and from surfaces") {
    const float3 down{0, -1, 0};
    const std::vector<Light> lights{spot_light({0, 0, 0}, down, 2.0f, 0.1f, 0.3f),
                                    spot_light({0, 0, 0}, down, 1.0f, 0.4f, 0.8f),
                                    point_light({0, 0, 0}, 3.0f),
                                    disc_light({0, 0, 0}, down, 1.0f, 0.6366198f)};
    CHECK(share_of_narrow_cones(lights, 0.5f) == doctest::Approx(2.0 / 8.0));
    CHECK(share_of_narrow_cones(lights, 1.0f) == doctest::Approx(3.0 / 8.0));
    CHECK(share_of_narrow_cones({}, 1.0f) == 0.0);
}

TEST_CASE("culled weighs narrow spots one by one") {
    const std::vector<Light> lights = stage(2000, 0.1f);
    const auto exhaustive = make_sampler("exhaustive", lights);
    const auto culled = make_sampler("culled", lights);
    const auto groups = make_sampler("culled:group=5", lights);
    culled->begin_pass(0);
    groups->begin_pass(0);
    CHECK(missed(*culled, *exhaustive) < 0.05);
    CHECK(missed(*groups, *exhaustive) > 0.15);
    CHECK_FALSE(make_sampler("learned", lights)->wants_reports());
    CHECK(make_sampler("learned", stage(2000, 0.8f))->wants_reports());
}

}  // namespace lightcull
