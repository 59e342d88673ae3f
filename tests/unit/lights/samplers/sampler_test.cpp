#include <doctest/doctest.h>
#include <lightcull/error.h>
#include <lightcull/sampler_info.h>
#include <lightcull/samplers.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "lights/light/importance.h"
#include "unit/lights/light/importance_bound.h"
#include "unit/sanitizer.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

/// The samplers that are unbiased, with ranges so short that most lights are refused in most
/// passes.
const char* const kUnbiased[] = {
    "uniform",
    "power",
    "light_bvh",
    "light_bvh:importance=means",
    "exhaustive",
    "culled:accepted=4:sets=16",
    "culled:accepted=4:sets=1",
    "culled:accepted=4:sets=16:group=7",
    "culled:accepted=2:sets=4:group=20",
    "culled:accepted=1:sets=16:group=7",
    "paper:error_bound=auto:accepted=4:test=light",
    "paper:error_bound=auto:accepted=4:test=light:list=0",
    "paper:error_bound=auto:accepted=4:test=light:list=0:weight=g_over_p",
    "paper:error_bound=auto:accepted=4:test=light:list=3:weight=g_over_p",
};

bool is_blind(const std::string& description) {
    return description == "uniform" || description == "power";
}

/// The knowledge of whether a light reaches a point: whether bounds leave any doubt, and the answer
/// as far as one can tell.
struct Reach {
    bool possible, certain;
};
Reach reach_of(const LightTable& table, std::uint32_t light, const ShadingPoint& point) {
    const LightRecord& record = table.records[light];
    const Receiver receiver(table.frame.position(point.position), point.normal);
    const Approach way = approach(receiver.position, record.center);
    return {importance_bound(record, way, point.normal) > 0.0f,
            importance(record, way, receiver) > 0.0f};
}

/// The largest |z| over lights of: mean over keys of [light selected] / prob equals 1 where the
/// light can reach the point. `factor` spoils the probability of odd lights.
double worst_z(const std::string& description, const std::vector<Light>& lights,
               const ShadingPoint& point, float factor = 1.0f) {
    constexpr int kPasses = 10000, kDrawsPerPass = 8;
    const auto sampler = make_sampler(description, lights);
    const LightTable table = make_light_table(lights);
    std::vector<double> sum(lights.size()), sum2(lights.size());
    for (int pass = 0; pass < kPasses; ++pass) {
        sampler->begin_pass(static_cast<std::uint64_t>(pass));
        // Draws of a pass share its ranges: their mean is one sample.
        std::vector<double> mean(lights.size());
        for (int draw = 0; draw < kDrawsPerPass; ++draw) {
            const std::uint64_t key =
                static_cast<std::uint64_t>(pass) * kDrawsPerPass + static_cast<std::uint64_t>(draw);
            const Selection s = sampler->select(point, uniform_float(hash(key, 77)));
            if (s.prob > 0.0f) {
                mean[s.light] +=
                    1.0 / (s.prob * (s.light % 2 == 1 ? factor : 1.0f)) / kDrawsPerPass;
            }
        }
        for (std::size_t i = 0; i < lights.size(); ++i) {
            sum[i] += mean[i];
            sum2[i] += mean[i] * mean[i];
        }
    }
    double worst = 0.0;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const double mean = sum[i] / kPasses;
        const Reach reach = reach_of(table, i, point);
        if (!reach.certain && !is_blind(description)) {
            if (!reach.possible) CHECK(mean == 0.0);  // never chosen
            continue;
        }
        if (table.records[i].intensity == 0.0f) {
            CHECK(mean == 0.0);
            continue;
        }
        const double variance = (sum2[i] / kPasses - mean * mean) / kPasses;
        worst = std::max(worst, std::abs(mean - 1.0) / std::sqrt(variance + 1e-12));
    }
    return worst;
}

std::vector<Light> few_lights() {
    std::vector<Light> lights = with_suns(mixed_lights(30, 31, 1.5f), 12);
    lights[4].intensity = 0.0f;
    return lights;
}

/// The limit for 14 samplers, 3 points, 30 lights: one false alarm in 10,000 runs with other seeds.
const double kLimit = sidak_z(1e-4, 14 * 3 * 30);

/// The largest |z| over lights of: the weights of choosing a light, and of coming upon it with a
/// probability of 0.3, sum to 1 in the mean over passes. `factor` spoils the probability that
/// prob() gives to odd lights.
double worst_z_of_weights(const std::string& description, const std::vector<Light>& lights,
                          const ShadingPoint& point, double factor = 1.0) {
    constexpr int kPasses = 20000;
    constexpr double kOther = 0.3;
    constexpr double kOneEvent = 1.0 / (kOther * kPasses);  // one event, which may be missing where
                                                            // it is rare
    const auto sampler = make_sampler(description, lights);
    const LightTable table = make_light_table(lights);
    std::vector<double> sum(lights.size()), sum2(lights.size());
    for (int pass = 0; pass < kPasses; ++pass) {
        const auto key = static_cast<std::uint64_t>(pass);
        sampler->begin_pass(key);
        const Selection s = sampler->select(point, uniform_float(hash(key, 78)));
        for (std::uint32_t i = 0; i < lights.size(); ++i) {
            double prob = static_cast<double>(sampler->prob(point, s.receipt, i));
            if (i % 2 == 1) prob *= factor;
            double weights = kOther / (prob + kOther);
            if (s.prob > 0.0f && s.light == i) {
                weights += 1.0 / (static_cast<double>(s.prob) + kOther);
            }
            sum[i] += weights;
            sum2[i] += weights * weights;
        }
    }
    double worst = 0.0;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        if (table.records[i].intensity == 0.0f || !reach_of(table, i, point).certain) continue;
        const double mean = sum[i] / kPasses;
        const double variance = (sum2[i] / kPasses - mean * mean) / kPasses;
        worst = std::max(worst, std::abs(mean - 1.0) / std::sqrt(variance + kOneEvent * kOneEvent));
    }
    return worst;
}

const char* const kCulled[] = {
    "culled:sets=4",
    "culled:accepted=2:sets=4:group=1",
    "culled:accepted=2:sets=4:group=7",
    "culled:accepted=0.5:sets=4:group=1",
    "culled:accepted=0.5:sets=4:group=7",
};

}  // namespace

TEST_CASE("every light is selected as often as its probability says") {
    const std::vector<Light> lights = few_lights();
    const std::vector<ShadingPoint> points = mixed_points(3, 33, 1);
    for (const char* description : kUnbiased) {
        for (const ShadingPoint& point : points) {
            CAPTURE(description);
            CHECK(worst_z(description, lights, point) < kLimit);
        }
    }
}

TEST_CASE("the test above sees a probability that is wrong by a tenth") {
    const std::vector<Light> lights = few_lights();
    const ShadingPoint point = mixed_points(3, 33, 1)[0];
    for (const char* description : kUnbiased) {
        CAPTURE(description);
        CHECK(worst_z(description, lights, point, 1.1f) > kLimit);
    }
}

TEST_CASE("the test above sees that clamped never chooses lights out of range") {
    CHECK(worst_z("clamped:accepted=4", few_lights(), mixed_points(3, 33, 1)[0]) > kLimit);
}

TEST_CASE("weights of culled against another technique sum to one in the mean") {
    const std::vector<Light> lights = few_lights();
    const double limit = sidak_z(1e-4, 5 * 3 * 30);
    for (const ShadingPoint& point : mixed_points(3, 35, 1)) {
        for (const char* description : kCulled) {
            CAPTURE(description);
            CHECK(worst_z_of_weights(description, lights, point) < limit);
            CHECK(worst_z_of_weights(description, lights, point, 1.5) > limit);
        }
    }
}

TEST_CASE("prob() equals what select() says, to the bit") {
    const std::vector<Light> lights = with_suns(mixed_lights(500, 41, 6.0f), 40);
    for (const char* description :
         {"uniform", "power", "light_bvh", "light_bvh:importance=means", "exhaustive", "clamped",
          "culled", "culled:sets=1", "culled:accepted=0.3:group=1", "culled:accepted=0.3:group=9",
          "paper:test=light:list=0", "paper:test=light:list=0:weight=g_over_p"}) {
        CAPTURE(description);
        const auto sampler = make_sampler(description, lights);
        sampler->begin_pass(9);
        int chosen = 0;
        const auto points = mixed_points(2000, 42, sampler->set_count());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Selection s = sampler->select(points[i], uniform_float(hash(i, 43)));
            if (s.prob == 0.0f) continue;
            ++chosen;
            REQUIRE(s.prob <= 1.0f);
            REQUIRE(sampler->prob(points[i], s.receipt, s.light) == s.prob);
            REQUIRE(s.mis_prob == s.prob);
            if (sampler->needs_receipt()) continue;
            REQUIRE(sampler->prob(points[i], s.light) == s.prob);
        }
        CHECK(chosen > 1000);
    }
}

TEST_CASE("a batch gives what single calls give, to the bit") {
    const std::vector<Light> lights = with_suns(mixed_lights(700, 51, 6.0f), 40);
    for (const char* description :
         {"uniform", "power", "light_bvh", "light_bvh:importance=means", "exhaustive", "clamped",
          "culled", "culled:accepted=0.3:group=1", "culled:accepted=0.3:group=9", "paper"}) {
        const auto sampler = make_sampler(description, lights);
        sampler->begin_pass(2);
        for (const std::uint32_t count : {0u, 1u, 7u, 8u, 9u, 17u, 9000u}) {
            if (count == 9000 && std::strcmp(description, "exhaustive") == 0) continue;
            const auto points = mixed_points(count, 52, sampler->set_count());
            std::vector<float> u(count);
            for (std::uint32_t i = 0; i < count; ++i) u[i] = uniform_float(hash(i, 53));
            std::vector<Selection> batch(count);
            sampler->select(points, u, batch);
            for (std::uint32_t i = 0; i < count; ++i) {
                const Selection one = sampler->select(points[i], u[i]);
                REQUIRE(one.light == batch[i].light);
                REQUIRE(one.prob == batch[i].prob);
                REQUIRE(one.mis_prob == batch[i].mis_prob);
                REQUIRE(one.receipt.weight_sum == batch[i].receipt.weight_sum);
                REQUIRE(one.receipt.key == batch[i].receipt.key);
            }
        }
    }
}

TEST_CASE("no light, one light, dark lights") {
    const std::vector<Light> none, dark(3, point_light({1, 2, 3}, 0.0f)),
        one{point_light({1, 2, 3}, 4.0f)};
    const ShadingPoint point{{0, 0, 0}, {0, 0, 0}, 0};
    for (const char* description : {"uniform", "power", "light_bvh", "light_bvh:importance=means",
                                    "exhaustive", "clamped", "culled", "paper"}) {
        CAPTURE(description);
        for (const auto& lights : {none, dark}) {
            const auto sampler = make_sampler(description, lights);
            sampler->begin_pass(0);
            CHECK(sampler->select(point, 0.5f).prob == 0.0f);
            CHECK(sampler_info(*sampler)->count(point).accepted == 0);
        }
        const auto sampler = make_sampler(description, one);
        for (std::uint64_t pass = 0; pass < 20; ++pass) {
            sampler->begin_pass(pass);
            const Selection s = sampler->select(point, 0.999f);
            if (std::strcmp(description, "paper") == 0 && s.prob == 0.0f) continue;
            CHECK(s.light == 0);
            CHECK(s.prob == 1.0f);
        }
    }
}

TEST_CASE("auto accepts as many lights as it was told, at any scale and brightness") {
    for (const float size : {1e-3f, 1.0f, 1e3f}) {
        for (const float brightness : {1e-3f, 1.0f, 1e3f}) {
            std::vector<Light> lights = mixed_lights(repetitions(5000u, 500u), 61, 4.0f);
            for (Light& light : lights) {
                light.center = light.center * size;
                light.radius *= size;
                light.intensity *= brightness;
            }
            std::vector<ShadingPoint> points = mixed_points(200, 62, 1, 1.0f);
            for (ShadingPoint& point : points) point.position = point.position * size;
            SamplerContext context;
            context.calibration_points = points;
            for (const char* description : {"culled:accepted=16", "clamped:accepted=16"}) {
                CAPTURE(description);
                const auto sampler = make_sampler(description, lights, context);
                CHECK(accepted_per_point(*sampler, points, 20) ==
                      doctest::Approx(16.0).scale(0.0).epsilon(0.05));
            }
        }
    }
}

TEST_CASE("points on lights, and where no light comes to, do not count when auto is found") {
    std::vector<Light> ceiling;
    std::vector<ShadingPoint> lit, mixed;
    RandomStream random(5);
    const auto place = [&](float y) {
        return float3{8.0f * random.next(), y, 8.0f * random.next()};
    };
    for (int i = 0; i < 800; ++i) {
        const float3 a = place(3.0f);
        ceiling.push_back(triangle_light(a, a + float3{0.1f, 0, 0}, a + float3{0, 0, 0.1f}, 1.0f));
    }
    for (int i = 0; i < 100; ++i) {
        lit.push_back({place(0.0f), {0, 1, 0}, 0});
        mixed.push_back(lit.back());
        mixed.push_back({ceiling[static_cast<std::size_t>(i)].center, {0, -1, 0}, 0});
        mixed.push_back({place(5.0f), {0, 1, 0}, 0});
    }
    const auto accepted = [&](Span<const ShadingPoint> points) {
        SamplerContext context;
        context.calibration_points = points;
        return accepted_per_point(*make_sampler("culled:group=1", ceiling, context), lit, 20);
    };
    CHECK(accepted(lit) == doctest::Approx(16.0).epsilon(0.05));
    CHECK(accepted(mixed) == accepted(lit));
    // No points are given, and the lights' bounds are flat.
    CHECK(accepted({}) > 8.0);
    CHECK(accepted({}) < 40.0);
}

TEST_CASE("culled weighs all lights where there are few") {
    const std::vector<Light> lights = mixed_lights(repetitions(60u, 60u), 71, 4.0f);
    const auto culled = make_sampler("culled", lights);
    const auto exhaustive = make_sampler("exhaustive", lights);
    culled->begin_pass(3);
    for (const ShadingPoint& point : mixed_points(50, 72, 1, 1.0f)) {
        const Selection all = exhaustive->select(point, 0.4f);
        const SelectionCounts few = sampler_info(*culled)->count(point);
        CHECK(few.accepted == sampler_info(*exhaustive)->count(point).accepted);
        CHECK((culled->select(point, 0.4f).prob > 0.0f) == (all.prob > 0.0f));
    }
}

TEST_CASE("a given error bound is that of Eq. 7, in the caller's units") {
    // The range follows from alpha = 2 pi eps / (E I): with E I / (2 pi eps) = 4 m^2 a light is
    // certain up to 2 m.
    const float error_bound = 10.0f * 3.0f / (2.0f * 3.14159265f * 4.0f);
    const std::vector<Light> lights{point_light({50, 0, 0}, 10.0f), point_light({0, 90, 0}, 0.1f)};
    CulledOptions options;
    options.range.error_bound = error_bound;
    options.range.exposure = 3.0f;
    const auto sampler = make_sampler(options, lights);
    const auto acceptance = [&](float distance) {
        int accepted = 0;
        for (std::uint64_t pass = 0; pass < 4000; ++pass) {
            sampler->begin_pass(pass);
            accepted +=
                sampler_info(*sampler)->count({{50 + distance, 0, 0}, {0, 0, 0}, 0}).accepted > 0;
        }
        return accepted / 4000.0;
    };
    CHECK(acceptance(1.99f) == 1.0);
    CHECK(acceptance(4.0f) == doctest::Approx(0.25).scale(0.0).epsilon(0.15));
}

TEST_CASE("descriptions that make no sense are refused by name") {
    const std::vector<Light> lights = mixed_lights(5, 71);
    const auto message = [&](const char* description) {
        try {
            make_sampler(description, lights);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const auto says = [](const std::string& text, const char* part) {
        return text.find(part) != std::string::npos;
    };
    CHECK(says(message("cullled"), "there are uniform, power"));
    CHECK(says(message("culled:sets"), "KEY=VALUE"));
    CHECK(says(message("culled:sets=12"), "power of 4"));
    CHECK(says(message("culled:sets=x"), "'x'"));
    CHECK(says(message("culled:sets=4:sets=4"), "twice"));
    CHECK(says(message("uniform:sets=4"), "no option 'sets'"));
    CHECK(says(message("light_bvh:sets=4"), "no option 'sets'"));
    CHECK(says(message("light_bvh:importance=mean"), "wanted means or bounds"));
    CHECK(says(message("culled:error_bound=-1"), "error_bound"));
    CHECK(says(message("culled:accepted=0"), "expected_accepted"));
    CHECK(says(message("paper:list=65"), "list is 65"));
    CHECK(says(message("paper:test=edge"), "vertex or light"));
    CHECK(message("paper:test=light:list=8:weight=g_over_p:sets=16:error_bound=0.5:exposure=2")
              .empty());
}
