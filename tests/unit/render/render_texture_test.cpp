#include "render/texture.h"

#include <doctest/doctest.h>

#include <vector>

using lightcull::float3;
using lightcull::lookup;
using lightcull::mean_luminance;
using lightcull::Texture;
using lightcull::V2f;

namespace {

Texture grey(std::uint32_t width, std::uint32_t height, const std::vector<float>& values) {
    Texture t{width, height, {}};
    for (const float v : values) t.texels.push_back({v, v, v});
    return t;
}

}  // namespace

TEST_CASE("textures are looked up bilinearly, repeat, and have row 0 at the top") {
    const Texture t = grey(2, 2, {1, 2, 3, 4});
    CHECK(lookup(t, {0.25f, 0.75f}).x == doctest::Approx(1));
    CHECK(lookup(t, {0.75f, 0.75f}).x == doctest::Approx(2));
    CHECK(lookup(t, {0.25f, 0.25f}).x == doctest::Approx(3));
    CHECK(lookup(t, {0.75f, 0.25f}).x == doctest::Approx(4));
    CHECK(lookup(t, {0.5f, 0.5f}).x == doctest::Approx(2.5));
    CHECK(lookup(t, {0.0f, 0.75f}).x == doctest::Approx(1.5));
    CHECK(lookup(t, {7.75f, -3.75f}).x == doctest::Approx(4));
    CHECK(lookup(t, {-0.25f, 0.75f}).x == doctest::Approx(2));
    CHECK(std::isfinite(lookup(t, {1e30f, -1e30f}).x));
    const Texture one = grey(1, 1, {5});
    CHECK(lookup(one, {0.3f, 12.9f}).x == doctest::Approx(5));
}

TEST_CASE("the mean over a triangle is that of its lookups") {
    const V2f a(0, 0), b(1, 0), c(0, 1);
    CHECK(mean_luminance(grey(1, 1, {3}), a, b, c) == doctest::Approx(3));
    // The right half of the texture is bright; half of 3/4 of the area of the lower right triangle
    // lies there, whose diagonal runs from (0, 0) to (1, 1).
    std::vector<float> values(4096);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 64 < 32 ? 0.0f : 1.0f;
    const Texture halves = grey(64, 64, values);
    CHECK(mean_luminance(halves, a, b, {1, 1}) == doctest::Approx(0.75).scale(0.0).epsilon(0.02));
    CHECK(mean_luminance(halves, a, {1, 1}, c) == doctest::Approx(0.25).scale(0.0).epsilon(0.02));
    CHECK(mean_luminance(halves, {0.6f, 0.1f}, {0.9f, 0.1f}, {0.9f, 0.3f}) == doctest::Approx(1));
    CHECK(mean_luminance(halves, {0.1f, 0.1f}, {0.4f, 0.1f}, {0.4f, 0.3f}) == 0.0f);
}

TEST_CASE("the mean is never 0 where a lookup is not") {
    std::vector<float> values(262144, 0.0f);
    values[std::size_t{101} * 512 + 77] = 1.0f;
    const Texture spark = grey(512, 512, values);
    CHECK(mean_luminance(spark, {0, 0}, {1, 0}, {0, 1}) > 0.0f);
    CHECK(mean_luminance(spark, {0, 0}, {30, 0}, {0, 30}) > 0.0f);
    // The place is as far from the texel's middle as a lookup still feels it.
    const float u = (77.5f + 0.98f) / 512.0f, v = 1.0f - (101.5f - 0.98f) / 512.0f;
    CHECK(lookup(spark, {u, v}).x > 0.0f);
    CHECK(mean_luminance(spark, {u, v}, {u + 0.3f, v}, {u, v + 0.3f}) > 0.0f);
    CHECK(mean_luminance(spark, {u + 0.1f, v}, {u + 0.3f, v}, {u + 0.1f, v + 0.3f}) == 0.0f);
}
