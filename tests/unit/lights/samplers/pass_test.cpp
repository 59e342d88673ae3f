#include <doctest/doctest.h>
#include <lightcull/checked_sampler.h>
#include <lightcull/error.h>
#include <lightcull/samplers.h>
#include <lightcull/sets.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "base/random.h"
#include "unit/statistics.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

const char* const kAll[] = {"uniform",         "power",
                            "light_bvh",       "light_bvh:importance=means",
                            "paper",           "exhaustive",
                            "clamped",         "culled:sets=16",
                            "culled",          "culled:group=1:sets=4",
                            "culled:sets=1024"};

std::vector<Light> with_glossy(std::vector<Light> lights) {
    for (std::size_t i = 0; i < lights.size(); i += 3) {
        lights[i] = glossy_point_light(lights[i].center, {0, 1, 0}, 1.0f, 0.3f);
    }
    return lights;
}

std::vector<Selection> select_all(const LightSelector& sampler,
                                  const std::vector<ShadingPoint>& points) {
    std::vector<float> u(points.size());
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = uniform_float(hash(i, 7));
    std::vector<Selection> selections(points.size());
    sampler.select(points, u, selections);
    return selections;
}

bool same_bits(const std::vector<Selection>& a, const std::vector<Selection>& b) {
    return a.size() == b.size() &&
           std::memcmp(a.data(), b.data(), a.size() * sizeof(Selection)) == 0;
}

}  // namespace

TEST_CASE("a pass is what begin_pass() draws, to the bit, and outlives its sampler") {
    for (const auto& lights : {mixed_lights(700, 51, 6.0f), with_glossy(mixed_lights(90, 3, 4.0f)),
                               std::vector<Light>{}}) {
        for (const char* description : kAll) {
            CAPTURE(description);
            if (!lights.empty() && lights[0].lobe_alpha > 0.0f &&
                std::strstr(description, "sets=1024") != nullptr) {
                continue;  // 55 bytes a light and set
            }
            auto sampler = make_sampler(description, lights);
            const auto points = mixed_points(400, 8, sampler->set_count());
            std::vector<std::unique_ptr<const LightSelector>> passes;
            for (std::uint64_t number = 0; number < 3; ++number) {
                passes.push_back(sampler->pass(number));
            }
            std::vector<std::vector<Selection>> drawn;
            for (std::uint64_t number = 0; number < 3; ++number) {
                sampler->begin_pass(number);
                drawn.push_back(select_all(*sampler, points));
            }
            CHECK(passes[0]->set_count() == sampler->set_count());
            CHECK(passes[0]->needs_receipt() == sampler->needs_receipt());
            sampler.reset();
            for (std::size_t number = 0; number < 3; ++number) {
                CHECK(same_bits(select_all(*passes[number], points), drawn[number]));
            }
        }
    }
}

TEST_CASE("passes are drawn and used by many threads at once, and are the same bits") {
    const auto sampler = make_sampler("culled:sets=64", mixed_lights(3000, 5, 6.0f));
    sampler->begin_pass(100);
    const auto points = mixed_points(500, 9, sampler->set_count());
    constexpr std::size_t kThreads = 4;
    std::vector<std::vector<Selection>> results(kThreads);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < kThreads; ++t) {
        threads.emplace_back([&, t] {
            for (int round = 0; round < 5; ++round) {
                results[t] = select_all(*sampler->pass(t / 2), points);
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    CHECK(same_bits(results[0], results[1]));
    CHECK(same_bits(results[2], results[3]));
    CHECK_FALSE(same_bits(results[0], results[2]));
    const auto again = sampler->pass(100);
    CHECK(same_bits(select_all(*sampler, points), select_all(*again, points)));
}

namespace {

/// The worst z of the mean over samples of [light chosen] / prob at one point, which is 1 for each
/// light that can reach it. The samples come from one pass, whose sets are taken by
/// set_of_sample(), or are all the first.
double worst_z_of_one_pass(const LightSelector& pass, const std::vector<Light>& lights,
                           const ShadingPoint& where, std::uint32_t samples, bool spread) {
    std::vector<double> sums(lights.size()), squares(lights.size());
    for (std::uint32_t i = 0; i < samples; ++i) {
        ShadingPoint point = where;
        point.set = spread ? set_of_sample(11, 5, i, 0, pass.set_count()) : 0;
        const Selection s = pass.select(point, uniform_float(hash(i, 77)));
        if (s.prob == 0.0f) continue;
        sums[s.light] += 1.0 / static_cast<double>(s.prob);
        squares[s.light] += 1.0 / (static_cast<double>(s.prob) * static_cast<double>(s.prob));
    }
    double worst = 0.0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const double mean = sums[i] / samples;
        if (squares[i] == 0.0) continue;
        const double variance = squares[i] / samples - mean * mean;
        worst = std::max(worst, std::abs(mean - 1.0) / std::sqrt(variance / samples + 1e-12));
    }
    return worst;
}

}  // namespace

TEST_CASE("the samples of one pass converge where it has draws enough, and not by one set") {
    // The point is in the open, so that every light reaches it.
    std::vector<Light> lights;
    for (std::uint32_t i = 0; i < 40; ++i) {
        lights.push_back(point_light(
            {std::cos(0.7f * static_cast<float>(i)) * (2.0f + static_cast<float>(i % 7)), 1.0f,
             std::sin(0.7f * static_cast<float>(i)) * (2.0f + static_cast<float>(i % 5))},
            1.0f + static_cast<float>(i % 3)));
    }
    const ShadingPoint point{{0, 0, 0}, {0, 0, 0}, 0};
    const auto sampler = make_sampler("culled:sets=4096:accepted=4:group=1", lights);
    const auto pass = sampler->pass(3);
    // Stratified sets have less variance than is estimated, so that the z of 40 lights stays below
    // what a false-alarm rate of 1e-6 allows.
    const double limit = sidak_z(1e-6, static_cast<std::uint32_t>(lights.size()));
    CHECK(worst_z_of_one_pass(*pass, lights, point, 4096, true) < limit);
    CHECK(worst_z_of_one_pass(*pass, lights, point, 65536, false) > limit);  // the biased twin
}

TEST_CASE("a host that knows nothing of passes gets sets enough to converge") {
    std::vector<Light> lights;
    for (float x = 0.0f; x < 5000.0f; x += 1.0f) lights.push_back(point_light({x, 3, 0}, 1.0f));
    CHECK(make_sampler("culled", lights)->set_count() == 4096);
    SamplerContext whole_image;
    whole_image.points_per_pass = 320 * 240;
    CHECK(make_sampler("culled", lights, whole_image)->set_count() == 16);
}

TEST_CASE("a checked sampler answers what is right to the bit, and names what is wrong") {
    const std::vector<Light> lights = mixed_lights(200, 4, 4.0f);
    std::string fault;
    int faults = 0;
    const auto on_fault = [&](const std::string& text) {
        fault = text;
        ++faults;
    };
    const auto plain = make_sampler("culled:sets=16", lights);
    const auto checked =
        make_checked_sampler(make_sampler("culled:sets=16", lights), lights.size(), on_fault);
    const ShadingPoint good{{0, 0, 0}, {0, 1, 0}, 3};
    CHECK(checked->select(good, 0.5f).prob == 0.0f);
    CHECK(fault == "select(): begin_pass() must come first");
    plain->begin_pass(2);
    checked->begin_pass(2);
    faults = 0;
    const auto points = mixed_points(300, 8, 16);
    CHECK(same_bits(select_all(*plain, points), select_all(*checked, points)));
    CHECK(same_bits(select_all(*plain->pass(5), points), select_all(*checked->pass(5), points)));
    CHECK(faults == 0);

    const float nan = std::numeric_limits<float>::quiet_NaN();
    struct Case {
        const char* fault;
        ShadingPoint point;
        float u;
    };
    const Case cases[] = {
        {"position is not finite", {{nan, 0, 0}, {0, 1, 0}, 0}, 0.5f},
        {"normal is not finite", {{0, 0, 0}, {0, nan, 0}, 0}, 0.5f},
        {"the length of normal is neither 1 nor 0", {{0, 0, 0}, {0, 2, 0}, 0}, 0.5f},
        {"set is not below set_count()", {{0, 0, 0}, {0, 1, 0}, 16}, 0.5f},
        {"diffuse is not finite and 0 or more", {{0, 0, 0}, {0, 1, 0}, 0, -1.0f}, 0.5f},
        {"the length of lobe.axis is not 1",
         {{0, 0, 0}, {0, 1, 0}, 0, 1.0f, {{0, 3, 0}, 0.5f, 1.0f}},
         0.5f},
        {"lobe.alpha is not in (0, 1]",
         {{0, 0, 0}, {0, 1, 0}, 0, 1.0f, {{0, 1, 0}, 0.0f, 1.0f}},
         0.5f},
        {"lobe.peak is not finite and 0 or more",
         {{0, 0, 0}, {0, 1, 0}, 0, 1.0f, {{0, 1, 0}, 0.5f, nan}},
         0.5f},
        {"u is not in [0, 1)", {{0, 0, 0}, {0, 1, 0}, 0}, 1.0f},
    };
    for (const Case& c : cases) {
        for (const auto& selector :
             {std::shared_ptr<const LightSelector>(checked->pass(0)),
              std::shared_ptr<const LightSelector>(checked.get(), [](const LightSelector*) {})}) {
            CHECK(selector->select(c.point, c.u).prob == 0.0f);
            CHECK(fault == std::string("select(): point 0: ") + c.fault);
            Selection both[2] = {};
            const ShadingPoint two[] = {good, c.point};
            const float u[] = {0.5f, c.u};
            selector->select(two, u, both);
            CHECK(fault == std::string("select(): point 1: ") + c.fault);
            CHECK(both[0].prob == 0.0f);
        }
    }
    CHECK(checked->prob(good, {1.0f, 0}, 200) == 0.0f);
    CHECK(fault == "prob(): point 0: there is no light of that index");
    CHECK(checked->prob(good, {1.0f, 16}, 0) == 0.0f);
    CHECK(fault == "prob(): point 0: the receipt is of another sampler");
    Selection one[1];
    checked->select({&good, 1}, {}, one);
    CHECK(fault == "select(): there are 1 points, 0 u and room for 1 selections");
    CHECK_THROWS_AS(make_checked_sampler(nullptr, 1), Error);
    CHECK_THROWS_AS(make_checked_sampler(make_sampler("paper", lights), lights.size()), Error);
}
