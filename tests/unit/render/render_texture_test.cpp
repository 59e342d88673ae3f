#include "render/texture.h"

#include "base/random.h"
#include "render/texture_mean.h"

#include <doctest/doctest.h>

#include <cmath>
#include <utility>
#include <vector>

using lightcull::float3;
using lightcull::lookup;
using lightcull::RandomStream;
using lightcull::Texture;
using lightcull::TextureMean;
using lightcull::V2f;
using lightcull::V3f;

namespace {

Texture grey(std::uint32_t width, std::uint32_t height, const std::vector<float>& values) {
    Texture t{width, height, {}};
    for (const float v : values) t.texels.push_back({v, v, v});
    return t;
}

float mean(const Texture& texture, const V2f& a, const V2f& b, const V2f& c) {
    return TextureMean(texture).over(a, b, c);
}

/// Texels of many powers of ten, of which the brightest outshine all others together, and a third
/// is black.
Texture high_dynamic_range(std::uint32_t width, std::uint32_t height) {
    RandomStream random(5);
    std::vector<float> values(std::size_t{width} * height);
    for (float& v : values) {
        v = random.next() < 0.33f ? 0.0f : std::pow(10.0f, 8.0f * random.next() - 4.0f);
    }
    return grey(width, height, values);
}

/// The mean of lookups at the middles of n * n equal triangles.
double mean_of_lookups(const Texture& t, const V2f& a, const V2f& b, const V2f& c, int n) {
    double sum = 0.0;
    const auto add = [&](double i, double j) {
        const auto u = static_cast<float>(i / n), v = static_cast<float>(j / n);
        sum += static_cast<double>(lookup(t, a + (b - a) * u + (c - a) * v).x);
    };
    for (int i = 0; i < n; ++i) {
        for (int j = 0; i + j < n; ++j) {
            add(i + 1.0 / 3.0, j + 1.0 / 3.0);
            if (i + j + 1 < n) add(i + 2.0 / 3.0, j + 2.0 / 3.0);
        }
    }
    return sum / (static_cast<double>(n) * n);
}

float part_mean(const Texture& texture, TextureMean::Of of, const V2f& a, const V2f& b,
                const V2f& c) {
    return TextureMean(texture, of).over_part(a, b, c);
}

/// The part of its mean by which the mean over a triangle differs from that of lookups.
double error(const Texture& t, const V2f& a, const V2f& b, const V2f& c, int n = 1500) {
    return std::fabs(static_cast<double>(mean(t, a, b, c)) / mean_of_lookups(t, a, b, c, n) - 1.0);
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
    CHECK(mean(grey(1, 1, {3}), a, b, c) == doctest::Approx(3));
    // The right half of the texture is bright; half of 3/4 of the area of the lower right triangle
    // lies there, whose diagonal runs from (0, 0) to (1, 1). The lookups that the border and the
    // texture's edge blur make up for each other but for the corners at 0 and 1.
    std::vector<float> values(4096);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 64 < 32 ? 0.0f : 1.0f;
    const Texture halves = grey(64, 64, values);
    CHECK(mean(halves, a, b, {1, 1}) == doctest::Approx(0.75).scale(0.0).epsilon(0.01));
    CHECK(mean(halves, a, {1, 1}, c) == doctest::Approx(0.25).scale(0.0).epsilon(0.02));
    CHECK(mean(halves, {0.6f, 0.1f}, {0.9f, 0.1f}, {0.9f, 0.3f}) == doctest::Approx(1));
    CHECK(mean(halves, {0.1f, 0.1f}, {0.4f, 0.1f}, {0.4f, 0.3f}) == 0.0f);

    // Both windings, places between texels, repeats to either side, and a texture of odd size.
    const Texture map = high_dynamic_range(13, 7);
    CHECK(error(map, {0.1f, 0.2f}, {0.8f, 0.3f}, {0.4f, 0.9f}) < 1e-4);
    CHECK(error(map, {0.1f, 0.2f}, {0.4f, 0.9f}, {0.8f, 0.3f}) < 1e-4);
    CHECK(error(map, {0.31f, 0.2f}, {0.32f, 0.2f}, {0.31f, 0.23f}) < 1e-4);
    CHECK(error(map, {-3.3f, 2.1f}, {1.2f, -4.7f}, {5.1f, 3.9f}) < 1e-3);
    // A triangle that is a line in the texture, whichever corner comes between the others, one
    // nearly so, and one that is a point.
    const V2f p(-0.4f, 0.1f), q(0.2f, 0.4f), r(0.8f, 0.7f);
    CHECK(error(map, p, q, r) < 1e-4);
    CHECK(error(map, q, p, r) < 1e-4);
    CHECK(error(map, p, r, q) < 1e-4);
    CHECK(error(map, p, p, r) < 1e-4);
    CHECK(error(map, p, q, r + V2f(0, 1e-5f)) < 1e-4);
    CHECK(mean(map, q, q, q) == doctest::Approx(lookup(map, q).x));
}

TEST_CASE("the mean over a triangle is exact for large images too") {
    // Four texels, the only ones to shine, of an image of 4096 x 2048: each is a cone of volume 1
    // texel over the two triangles of the unit square.
    constexpr std::uint32_t kWidth = 4096, kHeight = 2048;
    std::vector<float> values(std::size_t{kWidth} * kHeight, 1e-3f);
    for (const auto& [x, y] :
         {std::pair{2000u, 1500u}, {3000u, 300u}, {801u, 1901u}, {9u, 2001u}}) {
        values[std::size_t{y} * kWidth + x] = 1e6f;
    }
    const Texture map = grey(kWidth, kHeight, values);
    const TextureMean means(map);
    // Three of them lie on one side of the diagonal from (0, 1) to (1, 0), one on the other.
    const double base = 1e-3, bright = 1e6 / (0.5 * kWidth * kHeight);
    const V2f a(0, 0), b(1, 0), c(0, 1), d(1, 1);
    CHECK(means.over(a, b, c) == doctest::Approx(base + 3.0 * bright).scale(0.0).epsilon(1e-5));
    CHECK(means.over(b, d, c) == doctest::Approx(base + bright).scale(0.0).epsilon(1e-5));
    // Repeated a thousand times, cut evenly, it is the mean of the texture.
    CHECK(means.over({0, 0}, {1000.3f, 0}, {0, 999.7f}) ==
          doctest::Approx(base + 2.0 * bright).scale(0.0).epsilon(0.05));
    // Far away nothing is certain, but that it is a mean.
    CHECK(means.over({1e30f, 0}, {0, 1e30f}, {-1e30f, -1e30f}) ==
          doctest::Approx(base + 2.0 * bright));
}

TEST_CASE("the mean is never 0 where a lookup is not") {
    std::vector<float> values(262144, 0.0f);
    values[std::size_t{101} * 512 + 77] = 1.0f;
    const Texture spark = grey(512, 512, values);
    CHECK(mean(spark, {0, 0}, {1, 0}, {0, 1}) > 0.0f);
    CHECK(mean(spark, {0, 0}, {30, 0}, {0, 30}) > 0.0f);
    // The place is as far from the texel's middle as a lookup still feels it.
    const float u = (77.5f + 0.98f) / 512.0f, v = 1.0f - (101.5f - 0.98f) / 512.0f;
    CHECK(lookup(spark, {u, v}).x > 0.0f);
    CHECK(mean(spark, {u, v}, {u + 0.3f, v}, {u, v + 0.3f}) > 0.0f);
    CHECK(mean(spark, {u + 0.1f, v}, {u + 0.3f, v}, {u + 0.1f, v + 0.3f}) == 0.0f);
}

TEST_CASE("the mean over a part of a triangle is 0 where only rounding would see a bright texel") {
    std::vector<float> values(64);
    values[0] = 1000.0f;
    const Texture t = grey(8, 8, values);
    const auto of = TextureMean::Of::kLuminance;
    // The texel is blended in up to a texel's width from its middle, at (1/16, 15/16).
    const float edge = 3.0f / 16.0f;
    CHECK(part_mean(t, of, V2f(edge, 0.9f), V2f(0.5f, 0.9f), V2f(0.5f, 0.7f)) == 0.0f);
    CHECK(mean(t, V2f(edge, 0.9f), V2f(0.5f, 0.9f), V2f(0.5f, 0.7f)) > 0.0f);
    const V2f a(0.1f, 0.9f), b(0.3f, 0.9f), c(0.1f, 0.8f);
    CHECK(part_mean(t, of, a, b, c) == mean(t, a, b, c));
}

TEST_CASE("the mean of a texture's squares is at least the square of its mean") {
    const Texture t = high_dynamic_range(13, 7);
    RandomStream random(6);
    for (int i = 0; i < 200; ++i) {
        const auto corner = [&] {
            const float x = random.next();
            return V2f(x, random.next());
        };
        const V2f a = corner(), b = corner(), c = corner();
        const auto mean = static_cast<double>(part_mean(t, TextureMean::Of::kLuminance, a, b, c));
        const auto square = static_cast<double>(part_mean(t, TextureMean::Of::kSquare, a, b, c));
        CHECK(square >= 0.9999 * mean * mean);
    }
    const Texture even = grey(2, 2, {3.0f, 3.0f, 3.0f, 3.0f});
    const V2f a(0.1f, 0.2f), b(0.9f, 0.3f), c(0.4f, 0.8f);
    const auto nine = static_cast<double>(part_mean(even, TextureMean::Of::kSquare, a, b, c));
    CHECK(nine == doctest::Approx(9.0).epsilon(1e-5));
}

TEST_CASE("texels of 8 and 16 bits are what they stand for, and one channel is grey") {
    const auto srgb = [](double x) {
        return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
    };
    for (const bool is_srgb : {true, false}) {
        for (const int value : {0, 1, 10, 11, 77, 188, 254, 255}) {
            const auto stands_for = [&](double x) { return is_srgb ? srgb(x) : x; };
            Texture eight{1, 1, {}};
            eight.is_srgb = is_srgb;
            eight.texels8 = {static_cast<std::uint8_t>(value), 0, 255};
            const V3f of_eight = lookup(eight, {0.5f, 0.5f});
            CHECK(static_cast<double>(of_eight.x) ==
                  doctest::Approx(stands_for(value / 255.0)).epsilon(1e-6));
            CHECK(of_eight.y == 0.0f);
            CHECK(of_eight.z == 1.0f);

            Texture sixteen{1, 1, {}};
            sixteen.is_srgb = is_srgb;
            sixteen.channels = 1;
            sixteen.texels16 = {static_cast<std::uint16_t>(257 * value + 3 * (value < 255))};
            const double part = sixteen.texels16[0] / 65535.0;
            const V3f of_sixteen = lookup(sixteen, {0.5f, 0.5f});
            CHECK(static_cast<double>(of_sixteen.x) ==
                  doctest::Approx(stands_for(part)).epsilon(1e-6));
            CHECK(of_sixteen.y == of_sixteen.x);
            CHECK(of_sixteen.z == of_sixteen.x);
        }
    }
}

TEST_CASE("texels of 8 bits are looked up, and have means, as the same ones of floats") {
    RandomStream random(3);
    Texture eight{13, 7, {}}, floats{13, 7, {}};
    eight.is_srgb = false;
    for (int i = 0; i < 13 * 7; ++i) {
        float3 rgb{};
        for (float* channel : {&rgb.x, &rgb.y, &rgb.z}) {
            eight.texels8.push_back(static_cast<std::uint8_t>(256.0f * random.next()));
            *channel = static_cast<float>(eight.texels8.back()) / 255.0f;
        }
        floats.texels.push_back(rgb);
    }
    for (int i = 0; i < 50; ++i) {
        const V2f uv(4.0f * random.next() - 2.0f, 4.0f * random.next() - 2.0f);
        const V2f p(random.next(), random.next()), q(random.next(), random.next());
        CHECK((lookup(eight, uv) - lookup(floats, uv)).length() < 1e-6f);
        CHECK(mean(eight, uv, p, q) == doctest::Approx(mean(floats, uv, p, q)).epsilon(1e-5));
    }
}
