#include <lightcull/instruction_set.h>
#include <lightcull/light_sampler.h>
#include <lightcull/sampler_info.h>
#include <lightcull/samplers.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/random.h"
#include "unit/lights/samplers/learned_lamps.h"
#include "unit/lights/simd/best_again.h"

namespace lightcull {
namespace {

/// Small bulbs of twelve triangles that face all ways: what a cluster of some of them sends to a
/// point is told by none of its means.
std::vector<Light> bulbs(int count) {
    std::vector<Light> lights;
    RandomStream random(5);
    for (int bulb = 0; bulb < count; ++bulb) {
        const float3 at{8.0f * random.next() - 4.0f, 3.0f + 0.2f * random.next(),
                        8.0f * random.next() - 4.0f};
        for (int side = 0; side < 12; ++side) {
            const auto corner = [&] {
                return float3{at.x + 0.02f * random.next(), at.y + 0.02f * random.next(),
                              at.z + 0.02f * random.next()};
            };
            const float3 a = corner(), b = corner(), c = corner();
            lights.push_back(triangle_light(a, b, c, 1000.0f));
        }
    }
    return lights;
}

/// The mean over points of the variance of a sample by the sampler where all is as `exhaustive`
/// says, relative to the square of the mean.
double misjudged(const LightSampler& sampler, const std::vector<Light>& lights,
                 const std::vector<ShadingPoint>& points) {
    const auto exhaustive = make_sampler("exhaustive", lights);
    double sum = 0.0;
    for (const ShadingPoint& point : points) {
        const Receipt all = exhaustive->select(point, 0.5f).receipt;
        const Receipt receipt = sampler.select(point, 0.5f).receipt;
        for (std::uint32_t i = 0; i < lights.size(); ++i) {
            const auto given = double{exhaustive->prob(point, all, i)};
            const auto prob = double{sampler.prob(point, receipt, i)};
            if (given > 0.0) sum += given * given / prob;
        }
    }
    return sum / static_cast<double>(points.size()) - 1.0;
}

/// In a corner of the ceiling: what little a wall hides leaves most of what clusters misjudge.
bool in_corner(const Light& light) {
    return light.center.x > 2.0f && light.center.z > 2.0f;
}

/// Reports that a wall hides from all points what is in the corner, and nothing else.
void teach_corner(LightSampler& sampler, const std::vector<Light>& lights) {
    const std::vector<ShadingPoint> points = floor_points(2000);
    for (std::uint64_t pass = 0; pass < 40; ++pass) {
        sampler.begin_pass(pass);
        auto outcomes = outcomes_of(sampler, lights, points, pass, true);
        for (LightOutcome& o : outcomes) o.visibility = in_corner(lights[o.light]) ? 0.0f : 1.0f;
        sampler.report(outcomes);
    }
    sampler.begin_pass(40);
}

}  // namespace

TEST_CASE("learned: up to 2,048 lights are each weighed where clusters of them are misjudged") {
    const std::vector<ShadingPoint> points = floor_points(40);
    for (const int count : {50, 170, 171}) {
        CAPTURE(count);
        const std::vector<Light> lights = bulbs(count);
        const auto sampler = make_sampler("learned", lights);
        const bool all = count <= 170;
        CHECK((misjudged(*sampler, lights, points) < 1e-4) == all);
        CHECK((sampler_info(*sampler)->count(points[0]).lights_tested == lights.size()) == all);
    }
    // Of lamps that shine all round, clusters tell enough.
    const std::vector<Light> even = lamps();
    const auto sampler = make_sampler("learned", even);
    teach(*sampler, even, floor_points(2000), 0, 12);
    std::size_t by_clusters = 0;
    for (const ShadingPoint& point : points) {
        by_clusters += sampler_info(*sampler)->count(point).lights_tested < even.size() ? 1 : 0;
    }
    CHECK(by_clusters > 30);
}

TEST_CASE("learned: where each light is weighed, probabilities are those of select and sum to 1") {
    const std::vector<Light> lights = bulbs(60);
    const auto sampler = make_sampler("learned", lights);
    teach_corner(*sampler, lights);
    std::size_t by_light = 0;
    for (const ShadingPoint& point : floor_points(60)) {
        const Selection s = sampler->select(point, 0.4f);
        const auto weighed = sampler_info(*sampler)->count(point).lights_tested;
        if (weighed < lights.size()) continue;  // a cluster may reach it of which no light does
        ++by_light;
        double sum = 0.0;
        for (std::uint32_t i = 0; i < lights.size(); ++i) {
            sum += double{sampler->prob(point, s.receipt, i)};
        }
        CHECK(sum == doctest::Approx(1.0).epsilon(1e-4));
        CHECK(sampler->prob(point, s.receipt, s.light) == s.prob);
    }
    CHECK(by_light > 15);
}

TEST_CASE("learned: where each light is weighed, what is hidden still counts for less") {
    const std::vector<Light> lights = bulbs(60);
    const std::vector<ShadingPoint> points = floor_points(2000);
    const auto share_of_hidden = [&](const LightSampler& sampler) {
        std::vector<Selection> chosen(points.size());
        sampler.select(points, numbers(points.size(), 77), chosen);
        double hidden = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            hidden += in_corner(lights[chosen[i].light]) ? 1.0 : 0.0;
        }
        return hidden / static_cast<double>(points.size());
    };
    const auto sampler = make_sampler("learned", lights);
    const double before = share_of_hidden(*sampler);
    teach_corner(*sampler, lights);
    CHECK(share_of_hidden(*sampler) < 0.5 * before);
}

TEST_CASE("learned: where each light is weighed, no instruction set and no batch changes a bit") {
    const BestAgain best_again;
    const std::vector<Light> lights = bulbs(60);
    const std::vector<ShadingPoint> points = floor_points(2000);
    const auto sampler = make_sampler("learned", lights);
    teach_corner(*sampler, lights);
    const std::vector<float> u = numbers(points.size(), 5);
    std::vector<Selection> expected(points.size()), found(points.size());
    sampler->select(points, u, expected);
    for (const std::string& name : instruction_sets()) {
        CAPTURE(name);
        use_instruction_set(name);
        sampler->select(points, u, found);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Selection one = sampler->select(points[i], u[i]);
            REQUIRE(found[i].light == expected[i].light);
            REQUIRE(found[i].prob == expected[i].prob);
            REQUIRE(one.light == expected[i].light);
            REQUIRE(one.prob == expected[i].prob);
        }
    }
}

TEST_CASE("learned: where each light is weighed, each is chosen as often as it should be") {
    const std::vector<Light> lights = bulbs(60);
    const auto sampler = make_sampler("learned", lights);
    constexpr int kNumbers = 400'000;
    std::vector<double> counts(lights.size());
    const ShadingPoint point = floor_points(1)[0];
    Receipt receipt;
    for (int i = 0; i < kNumbers; ++i) {
        const Selection s = sampler->select(point, (static_cast<float>(i) + 0.5f) / kNumbers);
        counts[s.light] += 1.0;
        receipt = s.receipt;
    }
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const double expected = double{sampler->prob(point, receipt, i)} * kNumbers;
        CHECK(std::abs(counts[i] - expected) < 2.0 + 1e-4 * kNumbers);
    }
}

}  // namespace lightcull
