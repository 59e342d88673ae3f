#include <doctest/doctest.h>
#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lights/glossy/influence_tree.h"
#include "unit/sanitizer.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

/// The values of alpha that are tested. 0: a diffuse point.
constexpr float kAlphas[] = {0.0f, 1e-3f, 3e-3f, 0.01f, 0.05f, 0.1f, 0.3f, 0.7f, 1.0f};

LightRecord record_of(const Light& light) {
    return make_light_table({&light, 1}).records[0];
}

/// A glossy point or, for an alpha of 0, a diffuse one; at the origin of its table.
DirectedLight light_of(float alpha, RandomStream& random) {
    const float3 axis = random_direction(random);
    const Light light = alpha > 0.0f ? glossy_point_light({1, 2, 3}, axis, 2.0f, alpha)
                                     : diffuse_point_light({1, 2, 3}, axis, 2.0f);
    return DirectedLight(record_of(light));
}

/// A random direction; every other one lies within a few alphas of the direction in which the light
/// emits most.
float3 direction_from(const DirectedLight& light, float alpha, RandomStream& random, int i) {
    const float3 any = random_direction(random);
    if (i % 2 == 0) return any;
    // The volume's centre lies in that direction.
    const float3 peak = light.volume(1.0f).center - light.center();
    const float spread = (alpha + 1e-3f) * 20.0f * random.next() * random.next();
    const float3 near = peak * (1.0f / std::max(length(peak), 1e-6f)) + any * spread;
    return near * (1.0f / length(near));
}

/// The farthest place in a direction whose distance() is at most `range`, metres from the light.
float reach_of(const DirectedLight& light, float3 direction, float range) {
    const Approach unit = approach(light.center() + direction, light.center());
    return range / light.distance(unit);
}

/// Glossy and diffuse points, every sixth of each kind, among others.
std::vector<Light> glossy_lights(std::uint32_t count, std::uint64_t seed, float least_alpha) {
    std::vector<Light> lights = mixed_lights(count, seed, 3.0f);
    RandomStream random(seed + 1);
    for (std::uint32_t i = 0; i < count; ++i) {
        const float3 axis = random_direction(random);
        const float alpha = std::pow(least_alpha, random.next());
        const Light& light = lights[i];
        if (i % 3 == 0) lights[i] = diffuse_point_light(light.center, axis, light.intensity);
        if (i % 3 == 1) lights[i] = glossy_point_light(light.center, axis, light.intensity, alpha);
    }
    return lights;
}

std::vector<LightRecord> records_of(const LightTable& table) {
    std::vector<LightRecord> records;
    for (const std::uint32_t i : table.lit) records.push_back(table.records[i]);
    return records;
}

struct Sets {
    std::vector<std::uint32_t> of_tree, of_all;
    std::size_t found = 0;  ///< number of leaves that the tree found
};

/// The records that are accepted at a point and reach it: found by the tree, and by asking all of
/// them.
Sets accepted(const InfluenceTree& tree, const std::vector<LightRecord>& records,
              const Frame& frame, const ShadingPoint& point) {
    const Receiver receiver(frame, point);
    const auto is_accepted = [&](std::uint32_t record) {
        const LightRecord& light = records[tree.order()[record]];
        const Approach way = approach(receiver.position, light.center);
        return tree.accepts(record, point.set, tree.light(record).distance(way)) &&
               importance(light, way, receiver) > 0.0f;
    };
    Sets sets;
    tree.for_near(receiver, point.set, [&](Span<const std::uint32_t> near) {
        for (const std::uint32_t record : near) {
            ++sets.found;
            if (is_accepted(record)) sets.of_tree.push_back(record);
        }
    });
    std::sort(sets.of_tree.begin(), sets.of_tree.end());
    for (std::uint32_t record = 0; record < records.size(); ++record) {
        if (is_accepted(record)) sets.of_all.push_back(record);
    }
    return sets;
}

/// The light that every light gives a point: its importance, times a factor of its own.
std::vector<double> contributions(const std::vector<Light>& lights, const ShadingPoint& point) {
    const LightTable table = make_light_table(lights);
    const Receiver receiver(table.frame, point);
    std::vector<double> values(lights.size(), 0.0);
    for (const std::uint32_t i : table.lit) {
        const LightRecord& light = table.records[i];
        const Approach way = approach(receiver.position, light.center);
        const double factor = 0.5 + static_cast<double>(uniform_float(hash(i, 3)));
        values[i] = factor * static_cast<double>(importance(light, way, receiver));
    }
    return values;
}

constexpr std::uint64_t kPasses = repetitions(4000, 1500);

/// The worst z, over each kind of light in turn, of the statement that the mean of contribution
/// / prob is the sum of contributions. `factor` spoils the probability of the glossy ones.
double worst_z(const std::string& description, const std::vector<Light>& lights,
               const ShadingPoint& at, double factor = 1.0) {
    constexpr std::size_t kKinds = 3;
    const auto sampler = make_sampler(description, lights);
    const std::vector<double> values = contributions(lights, at);
    double sum[kKinds] = {}, sum2[kKinds] = {}, exact[kKinds] = {};
    for (std::size_t i = 0; i < lights.size(); ++i) exact[i % kKinds] += values[i];
    ShadingPoint point = at;
    for (std::uint64_t pass = 0; pass < kPasses; ++pass) {
        sampler->begin_pass(pass);
        point.set = static_cast<std::uint32_t>(pass % sampler->set_count());
        const Selection s = sampler->select(point, uniform_float(hash(pass, 77)));
        if (!(s.prob > 0.0f)) continue;
        const std::size_t kind = s.light % kKinds;
        const double value =
            values[s.light] / (static_cast<double>(s.prob) * (kind == 1 ? factor : 1.0));
        sum[kind] += value;
        sum2[kind] += value * value;
    }
    // A light that is chosen less than once may be missing.
    const double one_event = (exact[0] + exact[1] + exact[2]) / kPasses;
    double worst = 0.0;
    for (std::size_t k = 0; k < kKinds; ++k) {
        const double mean = sum[k] / kPasses;
        const double variance = (sum2[k] / kPasses - mean * mean) / kPasses;
        worst = std::max(worst,
                         std::abs(mean - exact[k]) / std::sqrt(variance + one_event * one_event));
    }
    return worst;
}

/// The z of the statement that the contributions which a sampler finds and those of coming upon a
/// light with a probability of 0.3, weighed against each other by prob(), are in the mean all there
/// are. `factor` spoils the probabilities of all lights but the one selected.
double z_of_weights(const std::string& description, const std::vector<Light>& lights,
                    const ShadingPoint& point, double factor = 1.0) {
    constexpr double kOther = 0.3;
    const auto sampler = make_sampler(description, lights);
    const std::vector<double> values = contributions(lights, point);
    double exact = 0.0, sum = 0.0, sum2 = 0.0;
    for (const double value : values) exact += value;
    for (std::uint64_t pass = 0; pass < kPasses; ++pass) {
        sampler->begin_pass(pass);
        const Selection s = sampler->select(point, uniform_float(hash(pass, 79)));
        double found = 0.0;
        for (std::uint32_t i = 0; i < values.size(); ++i) {
            double prob = static_cast<double>(sampler->prob(point, s.receipt, i));
            if (s.prob > 0.0f && s.light == i) {
                found += values[i] / (prob + kOther);
            } else {
                prob *= factor;
            }
            found += values[i] * kOther / (prob + kOther);
        }
        sum += found;
        sum2 += found * found;
    }
    const double mean = sum / kPasses;
    return std::abs(mean - exact) / std::sqrt((sum2 / kPasses - mean * mean) / kPasses);
}

const char* const kDescriptions[] = {"culled:accepted=8:sets=1", "culled:accepted=8:sets=16",
                                     "culled:accepted=40:sets=4"};

/// The limit for 3 samplers, 4 alphas, 5 points, 3 kinds and their weights: one false alarm in
/// 10,000 runs with other seeds.
const double kLimit = sidak_z(1e-4, 3 * 4 * 5 * 4);

}  // namespace

TEST_CASE("volumes of directed lights hold every place with p > xi: a million directions") {
    constexpr int kLights = 1000, kDirections = 1000;
    RandomStream random(5);
    for (const float alpha : kAlphas) {
        CAPTURE(alpha);
        double farthest = 0.0;  // in radii
        for (int i = 0; i < kLights * kDirections; i += kDirections) {
            const DirectedLight light = light_of(alpha, random);
            const float range = std::exp2(20.0f * random.next() - 10.0f);
            const Ball ball = light.volume(range);
            for (int j = 0; j < kDirections; ++j) {
                const float3 w = direction_from(light, alpha, random, j);
                const float reach = reach_of(light, w, range);
                if (!(reach > 0.0f)) continue;  // behind its surface
                const double away =
                    static_cast<double>(length(light.center() + w * reach - ball.center));
                farthest = std::max(farthest, away / static_cast<double>(ball.radius));
            }
        }
        CHECK(farthest <= 1.0);
        CHECK(farthest > 0.998);  // it could not be smaller
    }
}

TEST_CASE("the distance of a glossy point is that of its spheroid, of a diffuse one its cosine's") {
    RandomStream random(6);
    for (const float alpha : {0.05f, 0.5f, 1.0f}) {
        const float3 axis = random_direction(random);
        const LightRecord record = record_of(glossy_point_light({0, 0, 0}, axis, 1.0f, alpha));
        const double a2 = std::pow(static_cast<double>(record.alpha()), 2.0);
        CHECK(record.alpha() == doctest::Approx(alpha).scale(0.0).epsilon(1e-3));
        for (int i = 0; i < 1000; ++i) {
            const float3 w = random_direction(random);
            const double c = static_cast<double>(dot(w, axis));
            // This is [TH17] Eq. 12, of the distance to the light.
            const double fall_off = 1.0 + 0.5 * (1.0 - c) * (1.0 / a2 - 1.0);
            const Receiver receiver(w * 3.0f, float3{0, 0, 0});
            const Approach way = approach(receiver.position, {0, 0, 0});
            CHECK(DirectedLight(record).distance(way) ==
                  doctest::Approx(3.0 * fall_off).scale(0.0).epsilon(2e-3));
            CHECK(importance(record, way, receiver) ==
                  doctest::Approx(1.0 / (9.0 * fall_off * fall_off)).scale(0.0).epsilon(4e-3));
        }
    }
    const float3 up{0, 1, 0};
    const DirectedLight diffuse(record_of(diffuse_point_light({0, 0, 0}, up, 1.0f)));
    const float3 slanted{0.6f, 0.8f, 0.0f};
    CHECK(diffuse.distance(approach(slanted * 2.0f, {0, 0, 0})) ==
          doctest::Approx(2.0 / std::sqrt(0.8)).scale(0.0).epsilon(1e-3));
    CHECK(std::isinf(diffuse.distance(approach(-up, {0, 0, 0}))));
}

TEST_CASE("the tree of directed lights accepts what brute force accepts") {
    std::size_t accepted_count = 0, found = 0, tested = 0;
    const auto compare = [&](const std::vector<Light>& lights, float reach, int passes) {
        const LightTable table = make_light_table(lights);
        const std::vector<LightRecord> records = records_of(table);
        InfluenceTree tree(records, RandomRanges(reach, 16));
        for (int pass = 0; pass < passes; ++pass) {
            const auto number = static_cast<std::uint64_t>(pass);
            tree.begin_pass(number);
            for (const ShadingPoint& point : mixed_points(500, number, 16, 1.5f)) {
                const Sets sets = accepted(tree, records, table.frame, point);
                REQUIRE(sets.of_tree == sets.of_all);
                accepted_count += sets.of_all.size();
                found += sets.found;
                tested += records.size();
            }
        }
    };
    for (const float reach : {1e-3f, 1e-2f, 1.0f}) {
        compare(glossy_lights(1000, 21, 1e-3f), reach, 20);
    }
    CHECK(accepted_count > 10000);
    CHECK(found < tested / 3);
    for (const std::uint32_t count : {1u, 2u, 8u, 9u, 65u}) {
        compare(glossy_lights(count, count, 0.05f), 0.1f, 4);
    }
}

TEST_CASE("culled is unbiased for glossy and diffuse points, from sharp to rough") {
    for (const float alpha : {2.5e-3f, 0.02f, 0.1f, 0.5f}) {
        CAPTURE(alpha);
        const std::vector<Light> lights = glossy_lights(120, 31, alpha);
        for (const ShadingPoint& point : mixed_points(5, 33, 1)) {
            for (const char* description : kDescriptions) {
                CAPTURE(description);
                CHECK(worst_z(description, lights, point) < kLimit);
                CHECK(z_of_weights(description, lights, point) < kLimit);
            }
        }
    }
}

TEST_CASE("the test above sees a probability that is wrong by a fifth, and constant ranges") {
    const std::vector<Light> lights = glossy_lights(120, 31, 0.5f);
    const std::vector<ShadingPoint> points = mixed_points(5, 33, 1);
    for (const char* description : kDescriptions) {
        CAPTURE(description);
        double worst = 0.0, worst_of_weights = 0.0;
        for (const ShadingPoint& point : points) {
            worst = std::max(worst, worst_z(description, lights, point, 1.2));
            worst_of_weights =
                std::max(worst_of_weights, z_of_weights(description, lights, point, 1.2));
        }
        CHECK(worst > kLimit);
        CHECK(worst_of_weights > kLimit);
    }
    CHECK(worst_z("clamped:accepted=8", lights, points[0]) > kLimit);
}

TEST_CASE("with glossy points prob() equals what select() says, and a batch single calls") {
    std::vector<Light> lights = glossy_lights(500, 41, 1e-2f);
    constexpr std::uint32_t kUnlit = 8;
    lights[kUnlit].intensity = 0.0f;
    for (const char* description :
         {"culled", "culled:accepted=2:sets=4", "culled:group=1", "exhaustive", "light_bvh",
          "light_bvh:importance=means", "paper:test=light:list=0:weight=g_over_p"}) {
        CAPTURE(description);
        const auto sampler = make_sampler(description, lights);
        sampler->begin_pass(2);
        const std::vector<ShadingPoint> points = mixed_points(1000, 43, sampler->set_count());
        std::vector<float> u;
        for (std::size_t i = 0; i < points.size(); ++i) u.push_back(uniform_float(hash(i, 5)));
        std::vector<Selection> batch(points.size());
        sampler->select(points, u, batch);
        int chosen = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Selection s = sampler->select(points[i], u[i]);
            CHECK(s.light == batch[i].light);
            CHECK(s.prob == batch[i].prob);
            if (!(s.prob > 0.0f)) continue;
            CHECK(s.light != kUnlit);
            ++chosen;
            CHECK(sampler->prob(points[i], s.receipt, s.light) == s.prob);
        }
        CHECK(chosen > 500);
    }
}

TEST_CASE("auto accepts as many directed lights as it was told") {
    const std::vector<Light> lights = glossy_lights(3000, 61, 0.05f);
    const std::vector<ShadingPoint> points = mixed_points(200, 63, 16);
    SamplerContext context;
    context.calibration_points = points;
    const auto sampler = make_sampler("culled:accepted=20:sets=16", lights, context);
    CHECK(accepted_per_point(*sampler, points, 30) ==
          doctest::Approx(20.0).scale(0.0).epsilon(0.05));
}

TEST_CASE("many glossy points have few sets, and clusters take a lobe for its mean") {
    SamplerContext context;
    context.points_per_pass = 2000000;
    CHECK(make_sampler("culled", mixed_lights(100, 71), context)->set_count() == 256);
    CHECK(make_sampler("culled", glossy_lights(100, 71, 0.1f), context)->set_count() == 16);
    CHECK(make_sampler("culled:sets=64", glossy_lights(100, 71, 0.1f), context)->set_count() == 64);

    // The two give as much light in all, seen from the side.
    const std::vector<Light> two{point_light({-1, 0, 0}, 1.0f),
                                 glossy_point_light({1, 0, 0}, {0, 1, 0}, 400.0f, 0.05f)};
    for (const char* description : {"light_bvh", "light_bvh:importance=means"}) {
        const auto sampler = make_sampler(description, two);
        sampler->begin_pass(0);
        const ShadingPoint point{{0, 0, 3}, {0, 0, 0}, 0};
        CHECK(sampler->prob(point, {}, 0) == doctest::Approx(0.5).scale(0.0).epsilon(0.01));
    }
}

TEST_CASE("glossy points that make no sense are refused by name") {
    const auto message = [](const Light& light, const char* description) {
        try {
            make_sampler(description, {&light, 1});
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const Light good = glossy_point_light({0, 0, 0}, {0, 1, 0}, 1.0f, 0.1f);
    CHECK(message(good, "culled").empty());
    Light light = good;
    light.lobe_alpha = 1e-4f;
    CHECK(message(light, "culled") ==
          "light 0: lobe_alpha is 0.000100, wanted 0.001000 to 1.000000");
    light = good;
    light.lobe_alpha = std::nanf("");
    CHECK(message(light, "power").find("lobe_alpha") != std::string::npos);
    light = good;
    light.radius = 1.0f;
    CHECK(message(light, "culled").find("radius of a glossy point") != std::string::npos);
    light = good;
    light.cos_theta_o = 1.0f;
    CHECK(message(light, "culled").find("cos_theta_o of a glossy point") != std::string::npos);
    light = good;
    light.two_sided = true;
    CHECK(message(light, "culled") == "light 0: two_sided is set, and it is a glossy point");
    light = good;
    light.axis = {0, 0, 0};
    CHECK(message(light, "culled").find("axis has length 0") != std::string::npos);
    CHECK(message(good, "culled:group=4") ==
          "group is 4, and there are glossy points, which do not share ranges");
}
