#include <doctest/doctest.h>
#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "base/float3_math.h"
#include "base/random.h"
#include "unit/statistics.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

bool same_bits(const Selection& a, const Selection& b) {
    const auto numbers = [](const Selection& s) {
        return std::array{s.prob, s.mis_prob, s.receipt.weight_sum};
    };
    const auto of_a = numbers(a), of_b = numbers(b);
    return std::memcmp(of_a.data(), of_b.data(), sizeof of_a) == 0 && a.light == b.light &&
           a.receipt.key == b.receipt.key;
}

const char* const kAll[] = {"uniform",
                            "power",
                            "light_bvh",
                            "light_bvh:importance=means",
                            "exhaustive",
                            "clamped",
                            "culled:sets=16",
                            "culled:sets=16:group=1",
                            "paper:list=0:test=light"};

std::vector<Light> moved(std::vector<Light> lights, float by) {
    for (std::size_t i = 0; i < lights.size(); ++i) {
        RandomStream random(hash(i, 99));
        const float x = random.next() - 0.5f, y = random.next() - 0.5f, z = random.next() - 0.5f;
        lights[i].center = lights[i].center + float3{x, y, z} * by;
        if (lights[i].directional) lights[i] = directional_light({x, y, z}, lights[i].intensity);
    }
    return lights;
}

/// The worst z over lights of the mean of [light chosen] / prob at a point, which is 1 for all
/// lights that it says can be chosen. The limit says how many false alarms there are.
double worst_z(LightSampler& sampler, const std::vector<Light>& lights, const ShadingPoint& point,
               const LightSampler& truth) {
    constexpr int kPasses = 60000;
    std::vector<double> sums(lights.size()), squares(lights.size());
    for (std::uint64_t pass = 0; pass < kPasses; ++pass) {
        sampler.begin_pass(pass);
        const Selection s = sampler.select(point, uniform_float(hash(pass, 5)));
        if (s.prob == 0.0f) continue;
        const double value = 1.0 / static_cast<double>(s.prob);
        sums[s.light] += value;
        squares[s.light] += value * value;
    }
    double worst = 0.0;
    const Selection any = truth.select(point, 0.5f);
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const bool possible = truth.prob(point, any.receipt, i) > 1e-4f;
        if (!possible) continue;
        const double mean = sums[i] / kPasses, variance = squares[i] / kPasses - mean * mean;
        worst = std::max(worst, std::abs(mean - 1.0) / std::sqrt(variance / kPasses + 1e-9));
    }
    return worst;
}

}  // namespace

TEST_CASE("after an update lights are chosen where they are now, without bias") {
    const std::vector<Light> before = with_suns(mixed_lights(60, 17, 3.0f), 20);
    std::vector<Light> after = moved(before, 1.0f);
    for (std::size_t i = 0; i < after.size(); i += 7) after[i].intensity = 0.0f;  // switched off
    for (std::size_t i = 1; i < after.size(); i += 5) after[i].intensity *= 3.0f;
    const ShadingPoint point{{0.3f, -0.2f, 0.1f}, {0, 0, 0}, 0};
    auto truth = make_sampler("exhaustive", after);
    truth->begin_pass(0);
    for (const char* description : kAll) {
        if (std::strcmp(description, "clamped") == 0) continue;  // biased
        CAPTURE(description);
        auto sampler = make_sampler(description, before);
        sampler->begin_pass(0);
        const auto old_pass = sampler->pass(3);
        const Selection old = old_pass->select(point, 0.4f);
        sampler->update(after, 1e9f);
        const double limit = sidak_z(1e-6, 60);
        CHECK(worst_z(*sampler, after, point, *truth) < limit);
        // Passes taken before still choose among the lights of then.
        const Selection again = old_pass->select(point, 0.4f);
        CHECK(same_bits(again, old));
        const Selection some = sampler->select(point, 0.7f);
        CHECK((some.prob == 0.0f || after[some.light].intensity > 0.0f));
    }
}

TEST_CASE("a tree is fitted while it is tight, and built anew when it is not, which is said") {
    const std::vector<Light> lights = with_suns(mixed_lights(3000, 5, 6.0f), 100);
    for (const char* description : {"light_bvh", "light_bvh:importance=means", "culled:sets=16"}) {
        CAPTURE(description);
        auto sampler = make_sampler(description, lights);
        const LightUpdate same = sampler->update(lights);
        CHECK(!same.rebuilt);
        CHECK(same.growth == doctest::Approx(1.0).epsilon(0.2));
        const LightUpdate little = sampler->update(moved(lights, 0.02f));
        CHECK(!little.rebuilt);
        CHECK(little.growth < 1.5f);
        // All lights trade places.
        std::vector<Light> shuffled = lights;
        for (std::size_t i = 0; i < shuffled.size(); ++i) {
            shuffled[i].center = lights[(i * 1777) % lights.size()].center;
        }
        const LightUpdate much = sampler->update(shuffled);
        CHECK(much.rebuilt);
        CHECK(much.growth > 2.0f);
        const LightUpdate after = sampler->update(shuffled);
        CHECK(!after.rebuilt);
        CHECK(after.growth == doctest::Approx(1.0).epsilon(0.2));
    }
}

TEST_CASE("lights are switched off in place; one that was never lit has the tree built anew") {
    std::vector<Light> lights = mixed_lights(500, 5, 6.0f);
    lights[7].intensity = 0.0f;
    const ShadingPoint point{{0, 0, 0}, {0, 0, 0}, 0};
    for (const char* description : {"light_bvh", "light_bvh:importance=means", "culled:sets=16"}) {
        CAPTURE(description);
        auto sampler = make_sampler(description, lights);
        std::vector<Light> off = lights;
        for (std::size_t i = 0; i < off.size(); ++i) {
            if (i != 11) off[i].intensity = 0.0f;
        }
        off[11] = point_light({0, 1, 0}, 1.0f);
        CHECK(!sampler->update(off, 1e9f).rebuilt);
        sampler->begin_pass(1);
        const Selection only = sampler->select(point, 0.9f);
        CHECK(only.light == 11);
        CHECK(only.prob == 1.0f);
        CHECK(!sampler->update(lights, 1e9f).rebuilt);
        std::vector<Light> on = lights;
        on[7].intensity = 1.0f;
        CHECK(sampler->update(on).rebuilt);
        for (Light& light : on) light.intensity = 0.0f;
        sampler->update(on);
        sampler->begin_pass(2);
        CHECK(sampler->select(point, 0.3f).prob == 0.0f);
    }
}

TEST_CASE("an update that makes no sense is named, and changes nothing") {
    const std::vector<Light> lights = mixed_lights(50, 5, 6.0f);
    const ShadingPoint point{{0, 0, 0}, {0, 0, 0}, 0};
    for (const char* description : kAll) {
        CAPTURE(description);
        auto sampler = make_sampler(description, lights);
        sampler->begin_pass(1);
        const Selection before = sampler->select(point, 0.3f);
        std::string message;
        try {
            sampler->update({lights.data(), 49});
        } catch (const Error& error) {
            message = error.what();
        }
        CHECK(message == "update: there are 49 lights, and the sampler was made over 50");
        std::vector<Light> wrong = lights;
        wrong[3].radius = -1.0f;
        CHECK_THROWS_WITH_AS(sampler->update(wrong),
                             "light 3: radius is -1.000000, wanted finite and >= 0", Error);
        const Selection after = sampler->select(point, 0.3f);
        CHECK(same_bits(after, before));
    }
}
