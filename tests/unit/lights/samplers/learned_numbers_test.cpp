#include <lightcull/light_sampler.h>
#include <lightcull/sampler_info.h>
#include <lightcull/samplers.h>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "base/random.h"
#include "base/sobol.h"
#include "unit/lights/samplers/learned_lamps.h"
#include "unit/statistics.h"

namespace lightcull {
namespace {

constexpr std::uint64_t kPasses = 8;

/// The mean over passes of what a lone point is given, relative to the truth, by numbers that cover
/// [0, 1) evenly from pass to pass. anew: they begin anew where the sampler has changed.
double mean_at(const ShadingPoint& point, const std::vector<Light>& lights, std::uint64_t key,
               bool anew) {
    double truth = 0.0, sum = 0.0;
    for (const Light& light : lights) truth += visible(point, light) ? given(point, light) : 0.0;
    const auto sampler = make_sampler("learned", lights);
    for (std::uint64_t pass = 0; pass < kPasses; ++pass) {
        sampler->begin_pass(hash(key, pass));
        const std::uint32_t changes = anew ? sampler->changes() : 0;
        const Selection chosen = sampler->select(point, SobolPoint(hash(key, changes), pass)[0]);
        const bool seen = visible(point, lights[chosen.light]);
        const LightOutcome outcome{point.position, point.normal, chosen.receipt, chosen.light,
                                   seen ? 1.0f : 0.0f};
        sampler->report({&outcome, 1});
        if (seen) sum += given(point, lights[chosen.light]) / double{chosen.prob};
    }
    return sum / truth / kPasses;
}

}  // namespace

TEST_CASE("passes by even numbers are unbiased if these begin anew where learned has changed") {
    // A cell that nobody else is in learns from this point's own numbers. 4 sigma: a false alarm in
    // 16,000.
    const std::vector<Light> lights = lamps(6);
    const ShadingPoint point{{0.7f, 0.0f, 0.3f}, {0, 1, 0}, 0};
    for (const bool anew : {true, false}) {
        CAPTURE(anew);
        statistics::Accumulator means;
        for (std::uint64_t key = 0; key < 4000; ++key) {
            means.add(mean_at(point, lights, mix(key), anew));
        }
        const double z = z_of(means.estimate(), {1.0, 0.0});
        CAPTURE(means.estimate().mean);
        if (anew) {
            CHECK(std::abs(z) < 4.0);
        } else {
            // The twin.
            CHECK(std::abs(z) > 6.0);
        }
    }
}

TEST_CASE("between changes learned chooses by where points lie, whatever is reported of them") {
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(6000);
    const auto truthful = make_sampler("learned", lights), lying = make_sampler("learned", lights);
    const auto same = [&] {
        const std::vector<float> u = numbers(points.size(), 99);
        std::vector<Selection> a(points.size()), b(points.size());
        truthful->select(points, u, a);
        lying->select(points, u, b);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (a[i].light != b[i].light || a[i].prob != b[i].prob) return false;
        }
        return true;
    };
    teach(*truthful, lights, points, 0, 9);
    teach(*lying, lights, points, 0, 9);
    const std::uint32_t changes = truthful->changes();
    const std::size_t cells = sampler_info(*truthful)->cell_count();
    CHECK(same());
    // Rounds 10 to 12 follow a change in the ninth; the next is in the thirteenth.
    for (std::uint64_t pass = 9; pass < 13; ++pass) {
        teach(*truthful, lights, points, pass, pass + 1);
        teach(*lying, lights, points, pass, pass + 1, false);
        CAPTURE(pass);
        const bool changed = pass + 1 == 13;
        CHECK(truthful->changes() == changes + (changed ? 1 : 0));
        CHECK(same() == !changed);
    }
    CHECK(sampler_info(*truthful)->cell_count() >= cells);
}

TEST_CASE("a point of which no ray was traced is met, and says nothing of lights") {
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(3000);
    const auto sampler = make_sampler("learned", lights);
    for (std::uint64_t pass = 0; pass < 2; ++pass) {
        sampler->begin_pass(pass);
        std::vector<LightOutcome> outcomes = outcomes_of(*sampler, lights, points, pass);
        for (LightOutcome& outcome : outcomes) {
            outcome.visibility = std::numeric_limits<float>::quiet_NaN();
        }
        sampler->report(outcomes);
    }
    sampler->begin_pass(2);
    const SamplerInfo& info = *sampler_info(*sampler);
    CHECK(info.cell_count() > 0);
    for (std::uint32_t light = 0; light < lights.size(); ++light) {
        CHECK(std::isnan(info.learned_visibility(points[0], light)));
    }
}

}  // namespace lightcull
