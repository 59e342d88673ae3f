#include <lightcull/error.h>
#include <lightcull/instruction_set.h>
#include <lightcull/light_sampler.h>
#include <lightcull/sampler_info.h>
#include <lightcull/samplers.h>

#include <doctest/doctest.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/random.h"
#include "unit/lights/samplers/learned_lamps.h"
#include "unit/lights/simd/best_again.h"
#include "unit/statistics.h"

namespace lightcull {
namespace {

double truth(const std::vector<Light>& lights, const ShadingPoint& point) {
    double sum = 0.0;
    for (const Light& light : lights) {
        if (visible(point, light)) sum += given(point, light);
    }
    return sum;
}

/// One-sample estimates of what points are given, relative to the truth at each of them.
struct Estimate {
    double mean, variance;
    double sigma;  ///< standard deviation of the mean
};
Estimate estimate(const LightSampler& sampler, const std::vector<Light>& lights,
                  const std::vector<ShadingPoint>& points, int rounds) {
    double sum = 0.0, squares = 0.0;
    std::vector<double> truths;
    truths.reserve(points.size());
    for (const ShadingPoint& point : points) truths.push_back(truth(lights, point));
    std::vector<Selection> selections(points.size());
    for (int round = 0; round < rounds; ++round) {
        sampler.select(points, numbers(points.size(), 1000 + static_cast<std::uint64_t>(round)),
                       selections);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!(selections[i].prob > 0.0f)) continue;
            const Light& light = lights[selections[i].light];
            if (!visible(points[i], light)) continue;
            const double value = given(points[i], light) / double{selections[i].prob} / truths[i];
            sum += value;
            squares += value * value;
        }
    }
    const double count = static_cast<double>(points.size()) * rounds;
    const double mean = sum / count, variance = squares / count - mean * mean;
    return {mean, variance, std::sqrt(variance / count)};
}

}  // namespace

TEST_CASE("learned without reports is culled, to the bit, where there are many lights") {
    const std::vector<Light> lights = lamps(9000);
    const std::vector<ShadingPoint> points = floor_points(500);
    const auto learned = make_sampler("learned", lights), culled = make_sampler("culled", lights);
    const std::vector<float> u = numbers(points.size(), 3);
    for (std::uint64_t pass = 0; pass < 3; ++pass) {
        learned->begin_pass(pass);
        culled->begin_pass(pass);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Selection a = learned->select(points[i], u[i]);
            const Selection b = culled->select(points[i], u[i]);
            REQUIRE(a.light == b.light);
            REQUIRE(a.prob == b.prob);
        }
    }
}

TEST_CASE("learned without reports weighs up to some thousand lights by one cut") {
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(4000);
    const auto sampler = make_sampler("learned", lights), culled = make_sampler("culled", lights);
    sampler->begin_pass(0);
    culled->begin_pass(0);
    const std::vector<float> u = numbers(points.size(), 5);
    std::vector<Selection> chosen(points.size());
    sampler->select(points, u, chosen);
    for (std::size_t i = 0; i < 100; ++i) {
        const Selection one = sampler->select(points[i], u[i]);
        CHECK((one.light == chosen[i].light && one.prob == chosen[i].prob));
        CHECK(sampler->knows(one.receipt));
        CHECK_FALSE(culled->knows(one.receipt));
        CHECK(sampler->prob(points[i], one.receipt, one.light) == doctest::Approx(one.prob));
        double sum = 0.0;
        for (std::uint32_t light = 0; light < lights.size(); ++light) {
            sum += double{sampler->prob(points[i], one.receipt, light)};
        }
        CHECK(sum == doctest::Approx(1.0).epsilon(1e-4));
    }
    const Estimate e = estimate(*sampler, lights, points, 10);
    CHECK(std::abs(e.mean - 1.0) < 4.0 * e.sigma);
    const auto means = make_sampler("light_bvh:importance=means", lights);
    CHECK(e.variance < 1.05 * estimate(*means, lights, points, 10).variance);
}

TEST_CASE("learned is unbiased for what it was told, true or not") {
    // One-sample estimates of a mean; 4 sigma: a false alarm in 16,000.
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(4000);
    const auto untaught = make_sampler("light_bvh:importance=means", lights);
    const double before = estimate(*untaught, lights, points, 10).variance;
    for (const bool truthful : {true, false}) {
        CAPTURE(truthful);
        const auto sampler = make_sampler("learned", lights);
        teach(*sampler, lights, points, 0, 24, truthful);
        const Estimate e = estimate(*sampler, lights, points, 50);
        CHECK(std::abs(e.mean - 1.0) < 4.0 * e.sigma);
        if (truthful) CHECK(e.variance < 0.6 * before);
        // The twin: a probability that is off by a tenth is seen.
        CHECK_FALSE(std::abs(1.1 * e.mean - 1.0) < 4.0 * e.sigma);
    }
}

TEST_CASE("learned: probabilities of a receipt are those of select, and sum to 1") {
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(2000);
    const auto sampler = make_sampler("learned", lights);
    teach(*sampler, lights, points, 0, 12);
    std::size_t taught = 0;
    for (std::size_t i = 0; i < 100; ++i) {
        const Selection s = sampler->select(points[i], 0.37f);
        if ((s.receipt.key >> 31) == 0) continue;
        ++taught;
        CHECK(sampler->prob(points[i], s.receipt, s.light) == doctest::Approx(s.prob));
        double sum = 0.0;
        for (std::uint32_t light = 0; light < lights.size(); ++light) {
            sum += double{sampler->prob(points[i], s.receipt, light)};
        }
        CHECK(sum == doctest::Approx(1.0).epsilon(1e-4));
    }
    CHECK(taught > 90);
}

TEST_CASE("learned asks for no reports where there are four lights, and has no cells") {
    for (const std::size_t count : {std::size_t{0}, std::size_t{4}, std::size_t{5}}) {
        std::vector<Light> lights = lamps();
        lights.resize(count);
        lights.push_back(point_light({1, 1, 1}, 0.0f));
        const auto sampler = make_sampler("learned", lights),
                   culled = make_sampler("culled", lights);
        CHECK(sampler->wants_reports() == (count > 4));
        const std::vector<ShadingPoint> points = floor_points(1000);
        teach(*sampler, lights, points, 0, 3);
        culled->begin_pass(3);
        CHECK((sampler_info(*sampler)->cell_count() == 0) == (count <= 4));
        CHECK(select_alike(*sampler, *culled, points) == (count == 0));
        const std::vector<std::uint8_t> saved = sampler->learned();
        sampler->restore_learned(saved);
        CHECK(sampler->learned() == saved);
        CHECK(sampler->wants_reports() == (count > 4));
    }
}

TEST_CASE("learned: where there are few lights, numbers that are close choose the same one") {
    for (const std::size_t count : {std::size_t{2}, std::size_t{4}, std::size_t{20}}) {
        std::vector<Light> lights = lamps();
        lights.resize(count);
        const auto changes = [&](const LightSampler& sampler) {
            constexpr int kNumbers = 2000;
            std::uint32_t last = 0, found = 0;
            for (int i = 0; i < kNumbers; ++i) {
                const float u = (static_cast<float>(i) + 0.5f) / kNumbers;
                const Selection s = sampler.select(floor_points(1)[0], u);
                found += i > 0 && s.light != last ? 1 : 0;
                last = s.light;
            }
            return found;
        };
        CHECK(changes(*make_sampler("learned", lights)) == count - 1);
        CHECK(changes(*make_sampler("exhaustive", lights)) > 5 * count);
    }
}

TEST_CASE("learned: where there are few lights, each is weighed as exhaustive weighs it") {
    std::vector<Light> lights = lamps();
    lights.resize(100);
    const std::vector<ShadingPoint> points = floor_points(4000);
    const auto sampler = make_sampler("learned", lights);
    for (std::uint64_t pass = 0; pass < 3; ++pass) {
        sampler->begin_pass(pass);
        for (std::size_t i = 0; i < 50; ++i) {
            double sum = 0.0;
            for (const Light& light : lights) sum += given(points[i], light);
            const Selection chosen = sampler->select(points[i], 0.3f);
            const double prob = given(points[i], lights[chosen.light]) / sum;
            CHECK(double{chosen.prob} == doctest::Approx(prob).epsilon(1e-3));
        }
        auto outcomes = outcomes_of(*sampler, lights, points, pass);
        for (LightOutcome& outcome : outcomes) outcome.visibility = 1.0f;
        sampler->report(outcomes);
    }
}

TEST_CASE("learned: the order of reports, and one point at a time or many, change no bit") {
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(2000);
    const auto a = make_sampler("learned", lights), b = make_sampler("learned", lights);
    teach(*a, lights, points, 0, 12);
    teach(*b, lights, points, 0, 12, true, true);
    const std::vector<float> u = numbers(points.size(), 5);
    std::vector<Selection> many(points.size());
    b->select(points, u, many);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Selection one = a->select(points[i], u[i]);
        REQUIRE(one.light == many[i].light);
        REQUIRE(one.prob == many[i].prob);
    }
}

TEST_CASE("learned: reports that make no sense, or are dropped, change nothing") {
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(1000);
    const auto a = make_sampler("learned", lights), b = make_sampler("learned", lights);
    teach(*a, lights, points, 0, 6);
    teach(*b, lights, points, 0, 6);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const LightOutcome wrong[] = {
        {{0, 0, 0}, {0, 1, 0}, {1.0f, 0}, 600, 1.0f},
        {{0, 0, 0}, {0, 1, 0}, {1.0f, 0}, 1, nan},
        {{0, 0, 0}, {0, 1, 0}, {1.0f, 0}, 1, 1.5f},
        {{nan, 0, 0}, {0, 1, 0}, {1.0f, 0}, 1, 1.0f},
        {{0, 0, 0}, {0, 1, 0}, {1.0f, 0xffffffffu}, 1, 1.0f},
    };
    b->report({wrong, 5});
    const Selection s = b->select(points[0], 0.5f);
    const LightOutcome dropped{points[0].position, points[0].normal, s.receipt, s.light, 0.0f};
    b->report({&dropped, 1});
    b->drop_reports();
    a->begin_pass(7);
    b->begin_pass(7);
    for (const ShadingPoint& point : points) {
        const Selection x = a->select(point, 0.5f), y = b->select(point, 0.5f);
        REQUIRE(x.light == y.light);
        REQUIRE(x.prob == y.prob);
    }
}

TEST_CASE("learned comes to rest after its rounds") {
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(500);
    const auto sampler = make_sampler("learned:rounds=4", lights);
    CHECK(sampler->wants_reports());
    teach(*sampler, lights, points, 0, 4);
    CHECK_FALSE(sampler->wants_reports());
    const Selection before = sampler->select(points[0], 0.5f);
    teach(*sampler, lights, points, 4, 8, false);
    const Selection after = sampler->select(points[0], 0.5f);
    CHECK(before.light == after.light);
    CHECK(before.prob == after.prob);
}

TEST_CASE("learned: after an update it learns anew, also from rest") {
    // Of two lights above a wall each is a cluster of its own. First the one is hidden, then the
    // other; what was learned counts for eight rays.
    std::vector<Light> lights = {point_light({-1, 1, 0}, 1.0f), point_light({1, 1, 0}, 1.0f)};
    for (int i = 0; i < 4; ++i) lights.push_back(point_light({0, -1, 0}, 1.0f));  // not of use
    ShadingPoint point;
    point.position = {0.1f, 0.0f, 0.1f};
    point.normal = {0, 1, 0};
    for (const char* const description : {"learned", "learned:rounds=3"}) {
        CAPTURE(description);
        const auto sampler = make_sampler(description, lights);
        std::uint64_t pass = 0;
        const auto look = [&](std::uint32_t light, int tries, float visibility) {
            const Receipt receipt = sampler->select(point, 0.5f).receipt;
            const LightOutcome outcome{point.position, point.normal, receipt, light, visibility};
            for (int i = 0; i < tries; ++i) sampler->report({&outcome, 1});
            sampler->begin_pass(++pass);
        };
        const auto visibility = [&](std::uint32_t light) {
            return double{sampler_info(*sampler)->learned_visibility(point, light)};
        };
        look(0, 1, 0.0f);  // makes the cell
        look(0, 180, 0.0f);
        look(0, 180, 0.0f);
        CHECK(visibility(0) == doctest::Approx(0.02 * 0.02));
        const bool rests = description != std::string("learned");
        CHECK(sampler->wants_reports() == !rests);
        lights[1].center.x += 0.01f;
        CHECK_FALSE(sampler->update(lights).rebuilt);
        sampler->begin_pass(++pass);
        CHECK(sampler->wants_reports());
        CHECK(visibility(0) == doctest::Approx(0.02 * 0.02));  // until there is news
        look(0, 24, 1.0f);
        CHECK(visibility(0) == doctest::Approx((24.0 + 0.1) / (32.0 + 0.1)).epsilon(0.01));
        // Rounds are counted anew.
        CHECK(sampler->wants_reports());
        look(0, 1, 1.0f);
        look(0, 1, 1.0f);
        CHECK(sampler->wants_reports() == !rests);
    }
}

TEST_CASE("learned: what was saved goes on to the bit, reports under way included") {
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(1500);
    for (const char* const description : {"learned", "learned:rounds=7"}) {
        CAPTURE(description);
        const auto whole = make_sampler(description, lights);
        teach(*whole, lights, points, 0, 7);
        whole->report(outcomes_of(*whole, lights, points, 7));
        const std::vector<std::uint8_t> saved = whole->learned();
        const auto resumed = make_sampler(description, lights);
        resumed->restore_learned(saved);
        CHECK(resumed->learned() == saved);
        for (LightSampler* const sampler : {whole.get(), resumed.get()}) {
            teach(*sampler, lights, points, 8, 12);
        }
        CHECK(select_alike(*whole, *resumed, points));
        CHECK(resumed->learned() == whole->learned());
        CHECK(resumed->wants_reports() == whole->wants_reports());
    }
}

TEST_CASE("learned: bytes that are not its own are refused, and nothing is lost") {
    std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(400);
    const auto sampler = make_sampler("learned", lights);
    teach(*sampler, lights, points, 0, 5);
    const std::vector<std::uint8_t> saved = sampler->learned();
    const auto restore = [&](LightSampler& into, const std::vector<std::uint8_t>& bytes) {
        into.restore_learned(bytes);
    };
    const auto culled = make_sampler("culled", lights);
    CHECK(culled->learned().empty());
    CHECK_THROWS_WITH_AS(restore(*culled, saved), doctest::Contains("does not learn"), Error);
    CHECK_THROWS_WITH_AS(restore(*sampler, {}), doctest::Contains("another version"), Error);
    lights[3].intensity *= 2.0f;
    const auto other = make_sampler("learned", lights);
    CHECK_THROWS_WITH_AS(restore(*other, saved), doctest::Contains("other lights"), Error);

    // Damage is found, or harms nothing that a selection relies on.
    RandomStream random(5);
    const auto victim = make_sampler("learned", lamps());
    const auto pick = [&](std::size_t size) {
        return static_cast<std::size_t>(random.next() * static_cast<float>(size));
    };
    for (int i = 0; i < 90; ++i) {
        std::vector<std::uint8_t> damaged = saved;
        if (i % 3 == 0) damaged.resize(pick(saved.size()));
        if (i % 3 != 0) damaged[pick(saved.size())] ^= static_cast<std::uint8_t>(1 << (i % 8));
        try {
            victim->restore_learned(damaged);
        } catch (const Error&) {
            CHECK(select_alike(*victim, *victim, points));
            continue;
        }
        CHECK(i % 3 != 0);
        teach(*victim, lamps(), points, 5, 6);
    }
    victim->restore_learned(saved);
    victim->begin_pass(5);
    CHECK(select_alike(*victim, *sampler, points));
}

TEST_CASE("learned: instruction sets and threads change no bit of what is learned") {
    const BestAgain best_again;
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(1500);
    std::vector<std::uint8_t> wanted;
    for (const std::string& name : instruction_sets()) {
        for (const int threads : {1, 3}) {
            CAPTURE(name);
            CAPTURE(threads);
            use_instruction_set(name);
            const auto sampler = make_sampler("learned", lights);
            tbb::task_arena arena(threads);
            for (std::uint64_t pass = 0; pass < 6; ++pass) {
                arena.execute([&] { sampler->begin_pass(pass); });
                const auto outcomes = outcomes_of(*sampler, lights, points, pass);
                arena.execute([&] {
                    tbb::parallel_for(std::size_t{0}, outcomes.size(), [&](std::size_t i) {
                        sampler->report({&outcomes[i], 1});
                    });
                });
            }
            arena.execute([&] { sampler->begin_pass(6); });
            if (wanted.empty()) wanted = sampler->learned();
            CHECK(sampler->learned() == wanted);
        }
    }
}

TEST_CASE("learned: a point's cell is one there is, and most often the one that serves it") {
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(2000);
    const auto sampler = make_sampler("learned", lights);
    const SamplerInfo& info = *sampler_info(*sampler);
    CHECK(info.cell_of(points[0]) == SamplerInfo::kNoCell);
    CHECK(info.cell_memory_size() < info.memory_size());
    const std::size_t before = info.cell_memory_size();
    teach(*sampler, lights, points, 0, 12);
    CHECK(info.cell_memory_size() > before + 1000 * info.cell_count());
    CHECK(info.cell_memory_size() < info.memory_size());
    std::vector<std::uint32_t> cells;
    std::size_t served = 0;
    for (const ShadingPoint& point : points) {
        const std::uint32_t cell = info.cell_of(point);
        REQUIRE(cell < info.cell_count());
        served += (sampler->select(point, 0.5f).receipt.key & 0x7fffffffu) == cell ? 1 : 0;
        cells.push_back(cell);
    }
    // A place within half a cell of a point lies in the point's own at 9 of 16.
    CHECK(served > points.size() / 2);
    CHECK(served < points.size());
    std::sort(cells.begin(), cells.end());
    const auto different = std::unique(cells.begin(), cells.end()) - cells.begin();
    CHECK(different > 10);
    CHECK(different < 500);
    ShadingPoint nowhere = points[0];
    nowhere.position.y = 1000.0f;
    CHECK(info.cell_of(nowhere) == SamplerInfo::kNoCell);
    CHECK(sampler_info(*sampler->pass(12))->cell_of(points[0]) == info.cell_of(points[0]));
    const auto culled = make_sampler("culled", lights);
    CHECK(sampler_info(*culled)->cell_of(points[0]) == SamplerInfo::kNoCell);
    CHECK(sampler_info(*culled)->cell_memory_size() == 0);
}

TEST_CASE("learned: the visibility of a light is the share of rays that arrived, within bounds") {
    // Each light is a cluster of its own. Before the first ray a tenth of one has arrived.
    enum : std::uint32_t { kSome, kNone, kAll, kNever, kBelow, kDark };
    const std::vector<Light> lights = {
        point_light({-1, 1, 0}, 1.0f), point_light({1, 1, 0}, 1.0f),
        point_light({0, 1, 1}, 1.0f),  point_light({0, 2, 0}, 1.0f),
        point_light({0, -1, 0}, 1.0f), point_light({0, 1, -1}, 0.0f)};
    ShadingPoint point;
    point.position = {0.1f, 0.0f, 0.1f};
    point.normal = {0, 1, 0};
    const auto sampler = make_sampler("learned", lights);
    const SamplerInfo& info = *sampler_info(*sampler);
    const auto report = [&](std::uint32_t light, int tries, int hits) {
        const Receipt receipt = sampler->select(point, 0.5f).receipt;
        for (int i = 0; i < tries; ++i) {
            const LightOutcome outcome{point.position, point.normal, receipt, light,
                                       i < hits ? 1.0f : 0.0f};
            sampler->report({&outcome, 1});
        }
    };
    sampler->begin_pass(0);
    CHECK(std::isnan(info.learned_visibility(point, kSome)));
    report(kSome, 1, 0);
    sampler->begin_pass(1);
    CHECK(std::isnan(info.learned_visibility(point, kSome)));
    report(kSome, 10, 4);
    report(kNone, 180, 0);
    report(kAll, 9, 9);
    report(kBelow, 1, 1);
    sampler->begin_pass(2);
    CHECK(info.learned_visibility(point, kSome) == doctest::Approx(4.1 / 10.1).epsilon(1e-6));
    CHECK(info.learned_visibility(point, kNone) == doctest::Approx(0.1 / 180.1).epsilon(1e-6));
    report(kNone, 180, 0);
    sampler->begin_pass(3);
    CHECK(info.learned_visibility(point, kNone) == doctest::Approx(0.02 * 0.02).epsilon(1e-6));
    CHECK(info.learned_visibility(point, kAll) == doctest::Approx(1.0).epsilon(1e-6));
    CHECK(std::isnan(info.learned_visibility(point, kNever)));
    CHECK(std::isnan(info.learned_visibility(point, kBelow)));
    CHECK(std::isnan(info.learned_visibility(point, kDark)));
    CHECK(sampler_info(*sampler->pass(3))->learned_visibility(point, kSome) ==
          info.learned_visibility(point, kSome));
    ShadingPoint nowhere = point;
    nowhere.position.y = -1000.0f;
    CHECK(std::isnan(info.learned_visibility(nowhere, kSome)));
    const auto culled = make_sampler("culled", lights);
    CHECK(std::isnan(sampler_info(*culled)->learned_visibility(point, kSome)));
}

TEST_CASE(
    "learned: means of passes agree with the truth, and a twin that weights passes does not") {
    // The mean over points of each pass, while learning goes on; 4 sigma of what passes differ by:
    // a false alarm in 16,000.
    const std::vector<Light> lights = lamps();
    const std::vector<ShadingPoint> points = floor_points(16);
    std::vector<double> truths;
    truths.reserve(points.size());
    for (const ShadingPoint& point : points) truths.push_back(truth(lights, point));
    constexpr int kRuns = 400;
    constexpr std::uint64_t kPasses = 12;
    statistics::Accumulator alike, by_variance;
    SamplerContext context;
    context.points_per_pass = static_cast<std::uint32_t>(points.size());
    const auto sampler = make_sampler("learned", lights, context);
    const std::vector<std::uint8_t> untaught = sampler->learned();
    for (std::uint64_t run = 0; run < kRuns; ++run) {
        sampler->restore_learned(untaught);
        statistics::Accumulator of_run;
        double weighted = 0.0, weights = 0.0;
        for (std::uint64_t pass = 0; pass < kPasses; ++pass) {
            const std::uint64_t number = run * kPasses + pass;
            sampler->begin_pass(number);
            std::vector<Selection> selections(points.size());
            sampler->select(points, numbers(points.size(), number), selections);
            statistics::Accumulator of_pass;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const Selection& s = selections[i];
                const bool seen = s.prob > 0.0f && visible(points[i], lights[s.light]);
                of_pass.add(seen ? given(points[i], lights[s.light]) / double{s.prob} / truths[i]
                                 : 0.0);
            }
            sampler->report(outcomes_of(*sampler, lights, points, number));
            const statistics::Estimate e = of_pass.estimate();
            of_run.add(e.mean);
            weighted += e.mean / e.variance;
            weights += 1.0 / e.variance;
        }
        alike.add(of_run.estimate().mean);
        by_variance.add(weighted / weights);
    }
    const auto z = [](const statistics::Estimate& e) {
        return (e.mean - 1.0) / std::sqrt(e.variance);
    };
    CHECK(std::abs(z(alike.estimate())) < 4.0);
    CHECK_FALSE(std::abs(z(by_variance.estimate())) < 4.0);
}

}  // namespace lightcull
