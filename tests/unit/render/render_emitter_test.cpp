#include "base/random.h"
#include "render/emitter.h"
#include "render/scene_data.h"
#include "unit/render/render_support.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

using namespace render_support;
using lightcull::Emitter;
using lightcull::EmitterSample;
using lightcull::RandomStream;
using lightcull::TriangleEmitter;
using lightcull::V2f;
using lightcull::V3d;
using lightcull::V3f;

namespace {

/// The solid angle of a triangle seen from the origin: Van Oosterom and Strackee 1983.
double solid_angle(const V3f& first, const V3f& second, const V3f& third) {
    const auto a = V3d(first).normalized(), b = V3d(second).normalized();
    const auto c = V3d(third).normalized();
    const double rest = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
    return 2.0 * std::atan2(std::fabs(a.dot(b.cross(c))), rest);
}

}  // namespace

TEST_CASE("a triangle's density is one per solid angle") {
    const lightcull::SceneData scene;
    const V3f a(10, 20, 30), b(11, 20, 29), c(9, 22, 28);  // far enough to be sampled by area
    const Emitter triangle = TriangleEmitter{a, b - a, c - a, V3f(5), 0, kNone, true};
    RandomStream random(1);
    statistics::Accumulator sum;
    for (int i = 0; i < 100000; ++i) {
        const float x = random.next();
        const EmitterSample s =
            sample_emitter(scene, triangle, V3f(0), {0.5, V2f(x, random.next())});
        CHECK(s.radiance.x == 5.0f);
        CHECK_FALSE(s.is_delta);
        sum.add(static_cast<double>(1.0f / s.pdf));
    }
    const statistics::Estimate exact{solid_angle(a, b, c), 0.0};
    CHECK(statistics::p_of_z(statistics::z_of(sum.estimate(), exact)) > statistics::least_p());
}

TEST_CASE("a near triangle is sampled uniformly by solid angle, whatever its shape") {
    struct Shape {
        V3f a, b, c;
    };
    const lightcull::SceneData scene;
    RandomStream random(2);
    for (const Shape& shape : {Shape{V3f(1, 2, 3), V3f(2, 2, 2), V3f(0, 4, 1)},
                               Shape{V3f(-9, 1, 0.05f), V3f(21, 1, 0), V3f(-9, 1, -0.05f)},
                               Shape{V3f(-50, 0.1f, -40), V3f(60, 0.1f, -40), V3f(0, 0.1f, 70)},
                               Shape{V3f(0.01f, 0.02f, -1), V3f(0.01f, 0.02f, 2), V3f(3, 4, 0)}}) {
        const auto& [a, b, c] = shape;
        const double whole = solid_angle(a, b, c);
        CAPTURE(whole);
        const TriangleEmitter t{a, b - a, c - a, V3f(5), 0, kNone, true};
        // The part next to each corner, half as long, has a share of the samples as of the angle.
        std::array<int, 3> counts{};
        constexpr int kSamples = 40000;
        for (int i = 0; i < kSamples; ++i) {
            const float x = random.next();
            const EmitterSample s = sample_emitter(scene, t, V3f(0), {0.5, V2f(x, random.next())});
            REQUIRE(static_cast<double>(s.pdf) == doctest::Approx(1.0 / whole).epsilon(1e-4));
            CHECK(s.pdf == triangle_pdf(t, V3f(0), s.place));
            const V3d normal = V3d(b - a).cross(V3d(c - a));
            const double area2 = normal.dot(normal);
            const V3d at(s.place - a);
            const double v = normal.dot(at.cross(V3d(c - a))) / area2;
            const double w = normal.dot(V3d(b - a).cross(at)) / area2;
            CHECK(std::min({v, w, 1.0 - v - w}) > -1e-5);
            if (v + w < 0.5) ++counts[0];
            if (v > 0.5) ++counts[1];
            if (w > 0.5) ++counts[2];
        }
        const std::array<V3f, 3> middles{(a + b) * 0.5f, (b + c) * 0.5f, (c + a) * 0.5f};
        const std::array<double, 3> shares{solid_angle(a, middles[0], middles[2]) / whole,
                                           solid_angle(b, middles[1], middles[0]) / whole,
                                           solid_angle(c, middles[2], middles[1]) / whole};
        for (std::size_t i = 0; i < 3; ++i) {
            CAPTURE(i);
            // 4 sigma of a count: a false alarm in 16,000.
            const double sigma = std::sqrt(kSamples * shares[i] * (1.0 - shares[i]));
            CHECK(std::abs(counts[i] - kSamples * shares[i]) < 4.0 * sigma + 1.0);
        }
    }
}

TEST_CASE("a one-sided triangle emits where its corners run anticlockwise, a two-sided one twice") {
    const lightcull::SceneData scene;
    TriangleEmitter t{V3f(0), V3f(1, 0, 0), V3f(0, 1, 0), V3f(1), 0, kNone, false};
    CHECK(emitted(scene, t, 0.3f, 0.3f, V3f(0, 0, 1)).x == 1.0f);
    CHECK(emitted(scene, t, 0.3f, 0.3f, V3f(0, 0, -1)).x == 0.0f);
    t.two_sided = true;
    CHECK(emitted(scene, t, 0.3f, 0.3f, V3f(0, 0, -1)).x == 1.0f);
}

TEST_CASE("the edge of a spot is where its angles say, however narrow it is") {
    for (const double outer : {0.5, 1.7e-2, 3.5e-4, 3.5e-5}) {
        for (const double part : {0.0, 0.8, 1.0}) {
            auto scene = std::make_shared<Scene>();
            const auto inner = static_cast<float>(part * outer);
            scene->add_spot_light({0, 0, 0}, {0, -1, 0}, {1, 1, 1}, inner,
                                  static_cast<float>(outer));
            const lightcull::SceneData& data = data_of(*scene);
            for (int i = 0; i < 100; ++i) {
                const double angle = 1.25 * outer * (i + 0.5) / 100.0;
                const V3f from(static_cast<float>(std::sin(angle)),
                               static_cast<float>(-std::cos(angle)), 0.0f);
                const auto s = sample_emitter(data, data.emitters[0], from, {0.5, V2f(0.5f)});
                const double off = std::pow(std::sin(0.5 * angle), 2);
                const double full = std::pow(std::sin(0.5 * part * outer), 2);
                const double end = std::pow(std::sin(0.5 * outer), 2);
                const double ramp = off < end ? (end - off) / (end - full) : 0.0;
                const double exact = off <= full ? 1.0 : ramp * ramp;
                // The direction of the way is rounded by some 1e-7.
                CHECK(std::fabs(static_cast<double>(s.radiance.x) - exact) < 0.02);
            }
        }
    }
}

TEST_CASE("from its own plane a triangle is not sampled") {
    const lightcull::SceneData scene;
    const Emitter t = TriangleEmitter{V3f(0), V3f(1, 0, 0), V3f(0, 1, 0), V3f(1), 0, kNone, true};
    CHECK(sample_emitter(scene, t, V3f(5, 5, 0), {0.5, V2f(0.5f)}).pdf == 0.0f);
    // A place on it is rounded to one side or the other, and sees nothing of it all the same.
    for (const float above : {0.0f, 6e-8f, -6e-8f}) {
        const EmitterSample s = sample_emitter(scene, t, V3f(0.25f, 0.3f, above), {0.5, V2f(0.5f)});
        CHECK((s.pdf == 0.0f || s.pdf > 1e4f));
    }
}
