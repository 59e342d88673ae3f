#include <doctest/doctest.h>
#include <lightcull/error.h>
#include <lightcull/light.h>
#include <lightcull/samplers.h>

#include <cmath>
#include <limits>
#include <string>

#include "lights/light/importance.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

TEST_CASE("a triangle's sphere holds its corners and is the smallest one") {
    RandomStream random(1);
    for (int i = 0; i < 1000; ++i) {
        const float3 a = random_in_box(random, 1), b = random_in_box(random, 1),
                     c = random_in_box(random, 1);
        const Light light = triangle_light(a, b, c, 2.0f);
        for (const float3 corner : {a, b, c}) {
            CHECK(length(corner - light.center) <= light.radius);
        }
        const float longest = std::max({length(b - a), length(c - b), length(a - c)});
        CHECK(light.radius >= 0.4999f * longest);
        CHECK(light.radius <= 0.5774f * longest);  // 1 / sqrt(3): the equilateral one
    }
}

TEST_CASE("a triangle's light has the same shape at every scale") {
    RandomStream random(5);
    const float scales[] = {1e-36f, 1e-30f, 1e-18f, 1e-12f, 2e-10f, 1.0f,
                            6e7f,   1e10f,  1e15f,  1e25f,  1e37f};
    for (int i = 0; i < 100; ++i) {
        const float3 a = random_in_box(random, 1), b = random_in_box(random, 1),
                     c = random_in_box(random, 1);
        const Light base = triangle_light(a, b, c, 1.0f);
        for (const float scale : scales) {
            CAPTURE(scale);
            // The radiance keeps the intensity in the range of floats where it can.
            const float radiance = std::min(std::max(1.0f / scale, 1e-37f), 1e37f);
            const Light light = triangle_light(a * scale, b * scale, c * scale, radiance, false);
            const float3 center = light.center * (1.0f / scale);
            CHECK(length(center - base.center) < 1e-4f * base.radius);
            CHECK(light.radius / scale == doctest::Approx(base.radius).epsilon(1e-4));
            CHECK(length(light.axis - base.axis) < 1e-4f);
            const double expected = double{base.intensity} * radiance * scale * scale;
            CHECK(light.intensity == doctest::Approx(expected).scale(0.0).epsilon(1e-4));
        }
    }
}

TEST_CASE("a light fainter than floats can tell is still lit, and a brighter one is refused") {
    const auto triangle = [](float size) {
        return triangle_light({0, 0, 0}, {size, 0, 0}, {0, size, 0}, 1.0f);
    };
    for (const Light& light :
         {triangle(1e-25f), triangle(1e-37f), sphere_light({0, 0, 0}, 1e-30f, 1.0f),
          disc_light({0, 0, 0}, {0, 0, 1}, 1e-30f, 1.0f),
          cylinder_light({0, 0, 0}, {1e-30f, 0, 0}, 1e-30f, 1.0f),
          bounded_light({0, 0, 0}, {1, 1, 1}, {0, 0, 1}, -1, 0, false, 1e-38f)}) {
        CHECK(light.intensity > 0.0f);
        const Light lights[] = {light};
        const auto sampler = make_sampler("exhaustive", lights);
        for (const float distance : {1.0f, 1e6f}) {
            const float3 x = float3{0.3f, 0.2f, 1} * distance;
            CHECK(sampler->select({x, {0, 0, 0}, 0}, 0.5f).prob == 1.0f);
        }
    }
    const Light lights[] = {triangle(1.0f), triangle(1e20f)};
    CHECK_THROWS_WITH_AS(make_sampler("exhaustive", lights),
                         "light 1: intensity is inf, wanted finite and >= 0", Error);
    CHECK(triangle_light({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.0f).intensity == 0.0f);
}

TEST_CASE("a triangle's axis and intensity") {
    const Light light = triangle_light({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, 3.0f);
    CHECK(light.axis.z == 1.0f);
    CHECK(light.intensity == doctest::Approx(6.0f));
    CHECK(light.cos_theta_o == 1.0f);
    CHECK(triangle_light({0, 0, 0}, {1, 1, 1}, {2, 2, 2}, 3.0f).intensity == 0.0f);
}

TEST_CASE("power becomes peak intensity by the solid angle of the profile") {
    const float3 low{0, 0, 0}, high{2, 2, 2}, up{0, 1, 0};
    constexpr float kPi = 3.14159265f;
    const auto intensity = [&](float cos_o, float cos_e, bool two_sided) {
        return bounded_light(low, high, up, cos_o, cos_e, two_sided, 1.0f).intensity;
    };
    CHECK(intensity(1, 0, false) == doctest::Approx(1 / kPi));
    CHECK(intensity(1, 0, true) == doctest::Approx(0.5f / kPi));
    CHECK(intensity(-1, 0, false) == doctest::Approx(0.25f / kPi));
    // The cone of 60 degrees has no fall-off: 2 pi (1 - cos 60).
    CHECK(intensity(0.5f, 1, false) == doctest::Approx(1 / kPi));
    CHECK(length(float3{1, 1, 1}) <= bounded_light(low, high, up, 1, 0, false, 1).radius);
}

TEST_CASE("importance is 0 only where a light cannot reach") {
    RandomStream random(2);
    int reached = 0, refused = 0;
    for (int i = 0; i < 200000; ++i) {
        const float size = std::exp2(-12.0f * random.next());
        const float3 a = random_in_box(random, 1);
        const float3 b = a + random_direction(random) * size;
        const float3 c = a + random_direction(random) * size;
        const bool two_sided = i % 3 == 0;
        const Light light = triangle_light(a, b, c, 1.0f, two_sided);
        const Light lights[] = {light};
        const LightTable table = make_light_table(lights);
        const float3 x = a + random_direction(random) * (size * 4.0f * random.next());
        const float3 normal = random_direction(random);
        const float s = random.next(), t = random.next() * (1.0f - s);
        const float3 vertex = a + (b - a) * s + (c - a) * t;
        const float3 way = vertex - x;
        const float emitter = -dot(light.axis, way) / length(way);
        const float received = dot(normal, way) / length(way);
        const bool reaches = received > 1e-5f && (two_sided ? std::abs(emitter) : emitter) > 1e-5f;
        const Receiver receiver(table.frame.position(x), normal);
        const float g = importance(table.records[0],
                                   approach(receiver.position, table.records[0].center), receiver);
        if (reaches) {
            ++reached;
            REQUIRE(g > 0.0f);
        } else if (g == 0.0f) {
            ++refused;
        }
    }
    CHECK(reached > 30000);
    CHECK(refused > 30000);  // and it does tell what cannot be reached
}

TEST_CASE("a spot reaches as far as its outer cone and no farther") {
    const Light lights[] = {spot_light({0, 0, 0}, {0, 0, -2}, 5.0f, 0.3f, 0.8f)};
    const LightTable table = make_light_table(lights);
    const auto at = [&](float angle) {
        const float3 x{std::sin(angle), 0, -std::cos(angle)};
        const Receiver receiver(table.frame.position(x), float3{0, 0, 0});
        return importance(table.records[0], approach(receiver.position, table.records[0].center),
                          receiver);
    };
    CHECK(at(0.0f) == doctest::Approx(1.0f));
    CHECK(at(0.29f) == doctest::Approx(1.0f));
    CHECK(at(0.79f) > 0.0f);
    CHECK(at(0.82f) == 0.0f);
}

TEST_CASE("bad lights are named by number and field") {
    const auto message = [](void (*spoil)(Light&)) {
        std::vector<Light> lights = mixed_lights(10, 3);
        lights[7] = triangle_light({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1.0f);
        spoil(lights[7]);
        try {
            make_sampler(UniformOptions{}, lights);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const auto names = [](const std::string& text, const char* field) {
        return text.find(std::string("light 7: ") + field) == 0;
    };
    CHECK(names(message([](Light& l) { l.center.y = kNan; }), "center"));
    CHECK(names(message([](Light& l) { l.radius = -1; }), "radius"));
    CHECK(names(message([](Light& l) { l.radius = kInfinity; }), "radius"));
    CHECK(names(message([](Light& l) { l.intensity = -1; }), "intensity"));
    CHECK(names(message([](Light& l) { l.intensity = kInfinity; }), "intensity"));
    CHECK(names(message([](Light& l) { l.axis = {0, 0, 0.5f}; }), "axis"));
    CHECK(names(message([](Light& l) { l.cos_theta_o = 1.5f; }), "cos_theta_o"));
    CHECK(names(message([](Light& l) { l.cos_theta_e = -0.5f; }), "cos_theta_e"));
}

TEST_CASE("spheres, discs and tubes have the intensity of what one sees of them") {
    const Light sphere = sphere_light({1, 2, 3}, 0.5f, 4.0f);
    CHECK(sphere.radius == 0.5f);
    CHECK(sphere.cos_theta_o == -1.0f);
    CHECK(sphere.intensity == doctest::Approx(4.0 * 3.14159265 * 0.25));
    const Light disc = disc_light({1, 2, 3}, {0, 0, -3}, 0.5f, 4.0f, true);
    CHECK(disc.axis.z == -1.0f);
    CHECK(disc.cos_theta_o == 1.0f);
    CHECK(disc.two_sided);
    CHECK(disc.intensity == sphere.intensity);
    CHECK(disc.radius == 0.5f);
    // The light is a rectangle of 2 r by its length, seen from across.
    const Light tube = cylinder_light({0, 0, 0}, {0, 0, 6}, 0.25f, 4.0f);
    CHECK(tube.intensity == doctest::Approx(4.0 * 0.5 * 6.0));
    CHECK(tube.center.z == 3.0f);
    CHECK(tube.radius == doctest::Approx(std::hypot(3.0, 0.25)));
    CHECK(tube.radius >= std::hypot(3.0f, 0.25f));
}
