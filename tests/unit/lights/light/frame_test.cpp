#include "lights/light/frame.h"

#include <lightcull/light_sampler.h>
#include <lightcull/samplers.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/random.h"
#include "unit/test_lights.h"

namespace lightcull {
namespace {

/// Lamps above a floor, about a place.
std::vector<Light> lamps(std::size_t count, float3 place) {
    std::vector<Light> lights;
    RandomStream random(3);
    for (std::size_t i = 0; i < count; ++i) {
        const float3 at{16.0f * random.next() - 8.0f, 1.0f + 2.0f * random.next(),
                        16.0f * random.next() - 8.0f};
        lights.push_back(point_light(place + at, 0.5f + random.next()));
    }
    return lights;
}

/// A square of two triangles that gives the floor as much light as some lamps, as large in the sky
/// as the sun.
void add_sun(std::vector<Light>& lights, float distance) {
    const float edge = 0.0093f * distance;
    const float3 at{0.3f * distance, 0.9f * distance, 0.1f * distance};
    const float3 x{edge, 0, 0}, z{0, 0, edge};
    lights.push_back(triangle_light(at, at + x, at + z, 5000.0f));
    lights.push_back(triangle_light(at + x, at + x + z, at + z, 5000.0f));
}

/// What a light gives a place on the floor, in double precision.
double given(const Light& light, float3 x) {
    const double dx = double{light.center.x} - double{x.x};
    const double dy = double{light.center.y} - double{x.y};
    const double dz = double{light.center.z} - double{x.z};
    const double d2 = dx * dx + dy * dy + dz * dz, d = std::sqrt(d2);
    double emitted = double{light.intensity};
    if (light.cos_theta_o == 1.0f) {
        const double cosine =
            (double{light.axis.x} * dx + double{light.axis.y} * dy + double{light.axis.z} * dz) /
            -d;
        emitted *= std::max(cosine, 0.0);
    }
    return emitted * dy / (d2 * d);
}

std::vector<ShadingPoint> floor_points(std::size_t count, float3 place) {
    std::vector<ShadingPoint> points(count);
    RandomStream random(5);
    for (ShadingPoint& point : points) {
        point.position =
            place + float3{16.0f * random.next() - 8.0f, 0.0f, 16.0f * random.next() - 8.0f};
        point.normal = {0, 1, 0};
    }
    return points;
}

constexpr float kDistances[] = {1e3f, 1e5f, 1e7f, 1e8f, 1.5e11f};

}  // namespace

TEST_CASE("a far sun leaves near lamps their share, of every sampler") {
    for (const std::size_t count : {std::size_t{1}, std::size_t{100}}) {
        for (const float distance : kDistances) {
            CAPTURE(count);
            CAPTURE(distance);
            std::vector<Light> lights = lamps(count, {0, 0, 0});
            add_sun(lights, distance);
            const auto points = floor_points(count == 1 ? 20 : 8, {0, 0, 0});
            for (const char* const name :
                 {"exhaustive", "light_bvh", "light_bvh:importance=means"}) {
                CAPTURE(name);
                const auto sampler = make_sampler(name, lights);
                for (const ShadingPoint& point : points) {
                    const Receipt receipt = sampler->select(point, 0.5f).receipt;
                    double sum = 0.0, all = 0.0;
                    for (const Light& light : lights) all += given(light, point.position);
                    for (std::uint32_t i = 0; i < lights.size(); ++i) {
                        const double prob = double{sampler->prob(point, receipt, i)};
                        sum += prob;
                        const double share = given(lights[i], point.position) / all;
                        if (std::string("exhaustive") == name) {
                            CHECK(prob == doctest::Approx(share).scale(0.0).epsilon(2e-3));
                        } else {
                            CHECK(prob > 0.02 * share);
                        }
                    }
                    CHECK(sum == doctest::Approx(1.0).epsilon(1e-4));
                }
            }
        }
    }
}

TEST_CASE("a far sun leaves near lamps their light, by culled and learned") {
    for (const float distance : kDistances) {
        std::vector<Light> lights = lamps(100, {0, 0, 0});
        const std::uint32_t first_of_sun = 100;
        add_sun(lights, distance);
        const auto points = floor_points(64, {0, 0, 0});
        double wanted = 0.0;
        for (const ShadingPoint& point : points) {
            for (std::uint32_t i = 0; i < first_of_sun; ++i) {
                wanted += given(lights[i], point.position);
            }
        }
        for (const char* const name : {"culled", "learned"}) {
            CAPTURE(name);
            CAPTURE(distance);
            const auto sampler = make_sampler(name, lights);
            RandomStream random(9);
            constexpr int kPasses = 400;
            double sum = 0.0, squares = 0.0;
            for (std::uint64_t pass = 0; pass < kPasses; ++pass) {
                sampler->begin_pass(pass);
                double of_pass = 0.0;
                for (const ShadingPoint& point : points) {
                    const Selection s = sampler->select(point, random.next());
                    if (!(s.prob > 0.0f)) continue;
                    const LightOutcome outcome{point.position, point.normal, s.receipt, s.light, 1};
                    sampler->report({&outcome, 1});
                    if (s.light < first_of_sun) {
                        of_pass += given(lights[s.light], point.position) / double{s.prob};
                    }
                }
                sum += of_pass / wanted;
                squares += of_pass * of_pass / (wanted * wanted);
            }
            // 4 sigma: a false alarm in 16,000 for each.
            const double mean = sum / kPasses;
            const double sigma = std::sqrt((squares / kPasses - mean * mean) / kPasses);
            CHECK(sigma < 0.02);
            CHECK(std::abs(mean - 1.0) < 4.0 * sigma);
        }
    }
}

TEST_CASE("a frame holds all lights that are not far, wherever they are") {
    for (const float3 place : {float3{0, 0, 0}, float3{3e5f, 0, -1e6f}}) {
        std::vector<Light> lights = lamps(100, place);
        const Frame near = make_frame(lights);
        for (const Light& light : lights) {
            const float3 p = near.position(light.center);
            CHECK(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= 2.01f);
        }
        add_sun(lights, 1.5e11f);
        const Frame frame = make_frame(lights);
        CHECK(frame.inv_scale == near.inv_scale);
        CHECK(frame.intensity == near.intensity);
    }
    // Lights of no size at one place, and a light in the same room.
    const std::vector<Light> room{point_light({1, 1, 1}, 1.0f), point_light({1, 1, 1}, 2.0f),
                                  point_light({9, 1, 1}, 4.0f)};
    CHECK(make_frame(room).inv_scale == 0.25f);
    CHECK(make_frame(room).intensity == 4.0f);
    // Nor does a lamp of a micrometre make the others far, or any number end beyond all floats.
    CHECK(make_frame(std::vector<Light>{sphere_light({0, 0, 0}, 1e-6f, 1.0f),
                                        point_light({8, 1, 1}, 4.0f)})
              .inv_scale == doctest::Approx(0.25f));
    Light huge = point_light({3e38f, 0, 0}, 1.0f);
    huge.radius = 2e38f;
    const Frame widest = make_frame(std::vector<Light>{point_light({-3e38f, 0, 0}, 1.0f), huge});
    CHECK(std::isfinite(widest.origin.x));
    CHECK(widest.inv_scale > 0.0f);
}

TEST_CASE("a far sun does not make culled accept every lamp where no points are given") {
    std::vector<Light> lights = lamps(2000, {0, 0, 0});
    add_sun(lights, 1.5e11f);
    const auto sampler = make_sampler("culled:group=1", lights);
    const double accepted = testing::accepted_per_point(*sampler, floor_points(200, {0, 0, 0}), 1);
    CHECK(accepted > 8.0);
    CHECK(accepted < 60.0);
}

}  // namespace lightcull
