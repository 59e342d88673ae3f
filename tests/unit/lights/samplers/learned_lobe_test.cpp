#include <lightcull/instruction_set.h>
#include <lightcull/samplers.h>

#include <doctest/doctest.h>

#include <cmath>

#include "unit/lights/samplers/learned_lamps.h"
#include "unit/lights/simd/best_again.h"
#include "unit/statistics.h"

namespace lightcull {
namespace {

/// Points of a floor of metal, or of a coat over a diffuse floor, seen from one place.
std::vector<ShadingPoint> glossy_floor(std::size_t count, float diffuse) {
    std::vector<ShadingPoint> points = floor_points(count);
    for (ShadingPoint& point : points) {
        const float3 eye{0.0f, 1.6f, -6.0f};
        const float x = point.position.x - eye.x, y = eye.y, z = point.position.z - eye.z;
        const float inverse = 1.0f / std::sqrt(x * x + y * y + z * z);
        point.diffuse = diffuse;
        point.lobe.axis = {x * inverse, y * inverse, z * inverse};
        point.lobe.alpha = 0.04f;
        point.lobe.peak = 1.0f / (12.57f * 0.0016f * y * inverse);
    }
    return points;
}

/// BSDF times cosine by the formula of GlossyLobe.
double reflected(const ShadingPoint& point, const Light& light) {
    const double to[3] = {double{light.center.x} - double{point.position.x},
                          double{light.center.y} - double{point.position.y},
                          double{light.center.z} - double{point.position.z}};
    const double distance = std::sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
    const float3 axis = point.lobe.axis;
    const double h[3] = {to[0] / distance - double{axis.x}, to[1] / distance + double{axis.y},
                         to[2] / distance - double{axis.z}};
    const double sine2 = (h[0] * h[0] + h[2] * h[2]) / (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
    const double alpha = double{point.lobe.alpha};
    const double fall_off = 1.0 + sine2 * (1.0 / (alpha * alpha) - 1.0);
    return (double{point.diffuse} * to[1] / distance +
            double{point.lobe.peak} / (fall_off * fall_off)) *
           double{light.intensity} / (distance * distance);
}

std::vector<Selection> select_all(const LightSampler& sampler,
                                  const std::vector<ShadingPoint>& points) {
    std::vector<Selection> selections(points.size());
    sampler.select(points, numbers(points.size(), 7), selections);
    return selections;
}

/// The mean over points of the relative variance of one sample, of what they are given where
/// nothing is hidden; and how far the mean is off, in standard deviations.
struct Spread {
    double variance, sigmas;
};
Spread spread_of(const LightSampler& sampler, const std::vector<Light>& lights,
                 const std::vector<ShadingPoint>& points) {
    std::vector<Selection> selections(points.size());
    statistics::Accumulator values;
    for (std::uint64_t round = 0; round < 16; ++round) {
        sampler.select(points, numbers(points.size(), 500 + round), selections);
        for (std::size_t i = 0; i < points.size(); ++i) {
            double truth = 0.0;
            for (const Light& light : lights) truth += reflected(points[i], light);
            const Selection& s = selections[i];
            values.add(s.prob > 0.0f
                           ? reflected(points[i], lights[s.light]) / double{s.prob} / truth
                           : 0.0);
        }
    }
    const statistics::Estimate mean = values.estimate();
    return {mean.variance * 16.0 * static_cast<double>(points.size()),
            (mean.mean - 1.0) / std::sqrt(mean.variance)};
}

}  // namespace

TEST_CASE("learned: at glossy points probabilities are those of select, and sum to 1") {
    const std::vector<Light> lights = lamps();
    const auto sampler = make_sampler("learned", lights);
    teach(*sampler, lights, floor_points(2000), 0, 12);
    std::size_t taught = 0;
    for (const float diffuse : {0.0f, 0.3f}) {
        for (const ShadingPoint& point : glossy_floor(100, diffuse)) {
            const Selection s = sampler->select(point, 0.37f);
            if ((s.receipt.key >> 31) == 0) continue;
            ++taught;
            double sum = 0.0;
            for (std::uint32_t i = 0; i < lights.size(); ++i) {
                sum += double{sampler->prob(point, s.receipt, i)};
            }
            CHECK(sum == doctest::Approx(1.0).epsilon(1e-4));
            CHECK(sampler->prob(point, s.receipt, s.light) == s.prob);
        }
    }
    CHECK(taught > 150);
}

TEST_CASE("learned: at glossy points no instruction set and no batch changes a bit") {
    const BestAgain best_again;
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = glossy_floor(1000, 0.1f);
    const auto sampler = make_sampler("learned", lights);
    teach(*sampler, lights, floor_points(2000), 0, 12);
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

TEST_CASE("learned: glossy points that lie on lamps get finite probabilities") {
    const BestAgain best_again;
    const std::vector<Light> lights = lamps();
    std::vector<ShadingPoint> points = glossy_floor(lights.size(), 0.1f);
    for (std::size_t i = 0; i < lights.size(); ++i) points[i].position = lights[i].center;
    for (const std::string& name : instruction_sets()) {
        CAPTURE(name);
        use_instruction_set(name);
        const auto sampler = make_sampler("learned", lights);
        teach(*sampler, lights, points, 0, 6);
        for (const Selection& s : select_all(*sampler, points)) {
            REQUIRE(std::isfinite(s.prob));
            REQUIRE(s.prob >= 0.0f);
            REQUIRE(std::isfinite(s.receipt.weight_sum));
        }
    }
}

TEST_CASE("learned: at glossy points what clusters hide of a lobe is looked at closer") {
    // 4 sigma: a false alarm in 16,000.
    const std::vector<Light> lights = lamps();
    const auto learned = make_sampler("learned", lights);
    const auto clusters = make_sampler("light_bvh:importance=means", lights);
    const auto each = make_sampler("exhaustive", lights);
    for (std::uint64_t pass = 0; pass < 8; ++pass) {
        learned->begin_pass(pass);
        auto outcomes = outcomes_of(*learned, lights, floor_points(2000), pass);
        for (LightOutcome& outcome : outcomes) outcome.visibility = 1.0f;
        learned->report(outcomes);
    }
    learned->begin_pass(8);
    for (const float diffuse : {0.0f, 0.3f}) {
        const std::vector<ShadingPoint> points = glossy_floor(1500, diffuse);
        const Spread l = spread_of(*learned, lights, points);
        const Spread c = spread_of(*clusters, lights, points);
        const Spread e = spread_of(*each, lights, points);
        CAPTURE(diffuse);
        CAPTURE(c.variance);
        CAPTURE(e.variance);
        CAPTURE(l.variance);
        CHECK(std::abs(l.sigmas) < 4.0);
        CHECK(e.variance < 1e-3);
        CHECK(l.variance < 0.25 * c.variance);
    }
}

}  // namespace lightcull
