#include <lightcull/light_sampler.h>
#include <lightcull/samplers.h>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
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
/// [0, 1) evenly from pass to pass. apart: the sampler learns from other numbers than these.
double mean_at(const ShadingPoint& point, const std::vector<Light>& lights, std::uint64_t key,
               bool apart) {
    double truth = 0.0, sum = 0.0;
    for (const Light& light : lights) truth += visible(point, light) ? given(point, light) : 0.0;
    const auto sampler = make_sampler("learned", lights);
    const auto report = [&](const Selection& chosen) {
        const float visibility = visible(point, lights[chosen.light]) ? 1.0f : 0.0f;
        const LightOutcome outcome{point.position, point.normal, chosen.receipt, chosen.light,
                                   visibility};
        sampler->report({&outcome, 1});
    };
    for (std::uint64_t pass = 0; pass < kPasses; ++pass) {
        sampler->begin_pass(hash(key, pass));
        const Selection chosen = sampler->select(point, SobolPoint(key, SobolIndex(pass))[0]);
        const Light& light = lights[chosen.light];
        if (visible(point, light)) sum += given(point, light) / double{chosen.prob};
        report(apart ? sampler->select(point, uniform_float(hash(~key, pass))) : chosen);
    }
    return sum / truth / kPasses;
}

}  // namespace

TEST_CASE("by even numbers learned is unbiased if it learns from others") {
    // A cell that nobody else is in learns from this point alone. 4 sigma: a false alarm in 16,000.
    const std::vector<Light> lights = lamps(6);
    const ShadingPoint point{{0.7f, 0.0f, 0.3f}, {0, 1, 0}, 0};
    for (const bool apart : {true, false}) {
        CAPTURE(apart);
        statistics::Accumulator means;
        for (std::uint64_t key = 0; key < 4000; ++key) {
            means.add(mean_at(point, lights, mix(key), apart));
        }
        const double z = z_of(means.estimate(), {1.0, 0.0});
        CAPTURE(means.estimate().mean);
        if (apart) {
            CHECK(std::abs(z) < 4.0);
        } else {
            // The twin.
            CHECK(std::abs(z) > 6.0);
        }
    }
}

}  // namespace lightcull
