#include "base/random.h"
#include "render/environment.h"
#include "unit/statistics.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using lightcull::Environment;
using lightcull::EnvironmentMap;
using lightcull::EnvironmentSample;
using lightcull::EnvironmentValue;
using lightcull::RandomStream;
using lightcull::Texture;
using lightcull::unit;
using lightcull::V2f;
using lightcull::V3f;

namespace {

constexpr double kPi = 3.14159265358979323846;

/// A dim, uneven sky with a small sun, black below.
Environment sky() {
    Texture map{24, 12, {}};
    RandomStream random(11);
    for (std::uint32_t y = 0; y < 12; ++y) {
        for (std::uint32_t x = 0; x < 24; ++x) {
            const float v = y < 7 ? random.next() : 0.0f;
            map.texels.push_back({v, 0.5f * v, 2.0f * v});
        }
    }
    map.texels[3 * 24 + 17] = {300, 280, 200};
    return {map, {0.5f, 1.0f, 2.0f}, 0.7f};
}

V3f direction(double y, double angle) {
    const double sine = std::sqrt(1.0 - y * y);
    return {static_cast<float>(sine * std::cos(angle)), static_cast<float>(y),
            static_cast<float>(sine * std::sin(angle))};
}

double random_in(RandomStream& random) {
    return static_cast<double>(random.next());
}

}  // namespace

TEST_CASE("an environment's middle column is towards -Z, its right half towards +X, row 0 up") {
    Texture map{4, 2, {}};
    for (int i = 0; i < 8; ++i) {
        const auto v = static_cast<float>(i + 1);
        map.texels.push_back({v, v, v});
    }
    const EnvironmentMap upright({map, {1, 1, 1}, 0.0f});
    // The direction lies between texels 1 and 2, and between 5 and 6.
    CHECK(upright.at(unit(V3f(0, 1, -1))).radiance.x == doctest::Approx(2.5));
    CHECK(upright.at(unit(V3f(0, -1, -1))).radiance.x == doctest::Approx(6.5));
    // The direction lies between 2 and 3, and between 3 and 0.
    CHECK(upright.at(unit(V3f(1, 1, 0))).radiance.x == doctest::Approx(3.5));
    CHECK(upright.at(unit(V3f(0, 1, 1))).radiance.x == doctest::Approx(2.5));
    // A quarter turn about +Y carries -Z to -X.
    const EnvironmentMap turned({map, {1, 1, 1}, static_cast<float>(kPi / 2)});
    CHECK(turned.at(unit(V3f(-1, 1, 0))).radiance.x == doctest::Approx(2.5));
    CHECK(turned.at(unit(V3f(0, 1, -1))).radiance.x == doctest::Approx(3.5));
}

TEST_CASE("an environment's density integrates to 1 and is 0 only where the map is black") {
    const EnvironmentMap environment(sky());
    constexpr int kRows = 1200, kColumns = 2400;
    double sum = 0.0;
    for (int j = 0; j < kRows; ++j) {
        for (int i = 0; i < kColumns; ++i) {
            const V3f d = direction(2.0 * (j + 0.5) / kRows - 1.0, 2.0 * kPi * i / kColumns);
            const EnvironmentValue value = environment.at(d);
            sum += static_cast<double>(value.pdf);
            if (value.pdf == 0.0f) CHECK(value.radiance == V3f(0.0f));
        }
    }
    CHECK(sum * 4.0 * kPi / (kRows * kColumns) == doctest::Approx(1.0).scale(0.0).epsilon(2e-3));
}

TEST_CASE("environment samples agree with brute force") {
    const EnvironmentMap environment(sky());
    RandomStream random(2);
    statistics::Accumulator sampled, brute_force;
    const V3f normal = unit(V3f(0.3f, 0.8f, -0.4f));
    for (int i = 0; i < 100000; ++i) {
        const double cell = random_in(random);
        const float x = random.next();
        const EnvironmentSample s = environment.sample(cell, V2f(x, random.next()));
        CHECK(s.pdf == environment.at(s.direction).pdf);
        CHECK(s.direction.length() == doctest::Approx(1.0).scale(0.0).epsilon(1e-5));
        const float cosine = std::max(0.0f, s.direction.dot(normal));
        sampled.add(static_cast<double>(s.radiance.y * cosine / s.pdf));
    }
    for (int i = 0; i < 2000000; ++i) {
        const double y = 2.0 * random_in(random) - 1.0;
        const V3f d = direction(y, 2.0 * kPi * random_in(random));
        const float cosine = std::max(0.0f, d.dot(normal));
        brute_force.add(4.0 * kPi * static_cast<double>(environment.at(d).radiance.y * cosine));
    }
    const auto a = sampled.estimate(), b = brute_force.estimate();
    CHECK(statistics::p_of_z(statistics::z_of(a, b)) > statistics::least_p());
    CHECK(std::sqrt(a.variance) < 0.01 * a.mean);
}

TEST_CASE("a constant environment is sampled evenly, a black one not at all") {
    const EnvironmentMap white({{1, 1, {{2, 2, 2}}}, {1, 1, 1}, 0.0f});
    CHECK(white.at(V3f(0, 0, 1)).pdf == doctest::Approx(1.0 / (4.0 * kPi)));
    CHECK(white.at(V3f(0, 1, 0)).radiance.x == 2.0f);
    V3f mean(0.0f);
    RandomStream random(4);
    for (int i = 0; i < 10000; ++i) {
        const float x = random.next();
        mean += white.sample(0.5, V2f(x, random.next())).direction / 10000.0f;
    }
    CHECK(mean.length() < 0.03f);
    const EnvironmentMap black({{2, 1, {{0, 0, 0}, {0, 0, 0}}}, {1, 1, 1}, 0.0f});
    CHECK(black.sample(0.5, V2f(0.5f)).pdf == 0.0f);
    CHECK(black.at(V3f(0, 0, 1)).pdf == 0.0f);
}
