#include "base/random.h"
#include "render/emitter.h"
#include "render/scene_data.h"
#include "unit/render/render_support.h"

#include <doctest/doctest.h>

#include <cmath>
#include <variant>

using namespace render_support;
using lightcull::Emitter;
using lightcull::EmitterSample;
using lightcull::RandomStream;
using lightcull::TriangleEmitter;
using lightcull::V2f;
using lightcull::V3f;

namespace {

/// The solid angle of a triangle seen from the origin: Van Oosterom and Strackee 1983.
double solid_angle(V3f a, V3f b, V3f c) {
    a.normalize();
    b.normalize();
    c.normalize();
    const auto volume = static_cast<double>(a.dot(b.cross(c)));
    const auto rest = static_cast<double>(1.0f + a.dot(b) + b.dot(c) + c.dot(a));
    return 2.0 * std::atan2(std::fabs(volume), rest);
}

}  // namespace

TEST_CASE("a triangle's density is one per solid angle") {
    const lightcull::SceneData scene;
    const V3f a(1, 2, 3), b(2, 2, 2), c(0, 4, 1);
    const Emitter triangle = TriangleEmitter{a, b - a, c - a, V3f(5), 0, kNoTexture, true};
    RandomStream random(1);
    statistics::Accumulator sum;
    for (int i = 0; i < 100000; ++i) {
        const float x = random.next();
        const EmitterSample s = sample_emitter(scene, triangle, V3f(0), V2f(x, random.next()));
        CHECK(s.radiance.x == 5.0f);
        CHECK_FALSE(s.is_delta);
        sum.add(static_cast<double>(1.0f / s.pdf));
    }
    const statistics::Estimate exact{solid_angle(a, b, c), 0.0};
    CHECK(statistics::p_of_z(statistics::z_of(sum.estimate(), exact)) > statistics::least_p());
}

TEST_CASE("a one-sided triangle emits where its corners run anticlockwise, a two-sided one twice") {
    const lightcull::SceneData scene;
    TriangleEmitter t{V3f(0), V3f(1, 0, 0), V3f(0, 1, 0), V3f(1), 0, kNoTexture, false};
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
                const auto s = sample_emitter(data, data.emitters[0], from, V2f(0.5f));
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
    const Emitter t =
        TriangleEmitter{V3f(0), V3f(1, 0, 0), V3f(0, 1, 0), V3f(1), 0, kNoTexture, true};
    CHECK(sample_emitter(scene, t, V3f(5, 5, 0), V2f(0.5f)).pdf == 0.0f);
}
