#include "base/random.h"
#include "render/bsdf.h"
#include "unit/statistics.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using lightcull::Bsdf;
using lightcull::BsdfSample;
using lightcull::BsdfValue;
using lightcull::RandomStream;
using lightcull::V2f;
using lightcull::V3f;

namespace {

const V3f kUp(0.0f, 0.0f, 1.0f);

V3f direction(float cosine, float angle) {
    const float sine = std::sqrt(1.0f - cosine * cosine);
    return {sine * std::cos(angle), sine * std::sin(angle), cosine};
}

struct Case {
    const char* name;
    V3f base_color;
    float metallic, roughness;
    bool is_diffuse;

    Bsdf towards(const V3f& outgoing) const {
        return is_diffuse
                   ? Bsdf::diffuse(kUp, outgoing, base_color)
                   : Bsdf::metallic_roughness(kUp, outgoing, base_color, metallic, roughness);
    }
};

const std::vector<Case>& cases() {
    static const std::vector<Case> all{
        {"diffuse", V3f(0.8f, 0.5f, 0.2f), 0.0f, 1.0f, true},
        {"plastic", V3f(0.2f, 0.5f, 0.8f), 0.0f, 0.35f, false},
        {"rough plastic", V3f(0.9f), 0.0f, 1.0f, false},
        {"metal", V3f(1.0f, 0.8f, 0.4f), 1.0f, 0.4f, false},
        {"rough metal", V3f(0.9f), 1.0f, 0.9f, false},
        {"half metal", V3f(0.6f, 0.6f, 0.1f), 0.5f, 0.5f, false},
    };
    return all;
}

const std::vector<V3f>& views() {
    static const std::vector<V3f> all{direction(1.0f, 0.0f), direction(0.7f, 0.4f),
                                      direction(0.15f, 2.5f)};
    return all;
}

/// The cells have equal solid angle: they are equal in the cosine, and in the angle about the
/// normal.
constexpr int kRows = 8, kColumns = 16;
constexpr double kCellSolidAngle = 2.0 * 3.14159265358979323846 / (kRows * kColumns);

/// The integral of the density over each cell, by the midpoint rule.
std::vector<double> cell_probabilities(const Bsdf& bsdf) {
    constexpr int kPoints = 96;
    std::vector<double> probabilities(std::size_t{kRows} * kColumns, 0.0);
    for (int j = 0; j < kRows * kPoints; ++j) {
        for (int i = 0; i < kColumns * kPoints; ++i) {
            const float cosine = (static_cast<float>(j) + 0.5f) / (kRows * kPoints);
            const float turn = (static_cast<float>(i) + 0.5f) / (kColumns * kPoints);
            const int cell = j / kPoints * kColumns + i / kPoints;
            probabilities[static_cast<std::size_t>(cell)] +=
                static_cast<double>(
                    bsdf.evaluate(direction(cosine, turn * 2.0f * lightcull::kPi)).pdf) *
                kCellSolidAngle / (kPoints * kPoints);
        }
    }
    return probabilities;
}

std::size_t cell_of(const V3f& d) {
    const float turn = std::atan2(d.y, d.x) * 0.5f * lightcull::kInvPi;
    const auto row = static_cast<std::size_t>(d.z * kRows);
    const auto column = static_cast<std::size_t>((turn < 0.0f ? turn + 1.0f : turn) * kColumns);
    return std::min<std::size_t>(row, kRows - 1) * kColumns +
           std::min<std::size_t>(column, kColumns - 1);
}

}  // namespace

TEST_CASE("BSDF samples are distributed as their density says, which integrates to at most 1") {
    constexpr int kSamples = 200000;
    for (const Case& c : cases()) {
        for (const V3f& view : views()) {
            CAPTURE(c.name);
            CAPTURE(view.z);
            const Bsdf bsdf = c.towards(view);
            const std::vector<double> expected = cell_probabilities(bsdf);
            double total = 0.0;
            for (const double p : expected) total += p;
            CHECK(total <= 1.0 + 2e-3);

            std::vector<int> counts(expected.size(), 0);
            int absorbed = 0;
            RandomStream random(7);
            for (int i = 0; i < kSamples; ++i) {
                const float lobe = random.next();
                const float x = random.next();
                const BsdfSample s = bsdf.sample(lobe, V2f(x, random.next()));
                if (s.pdf > 0.0f) {
                    ++counts[cell_of(s.direction)];
                } else {
                    ++absorbed;
                }
            }
            // Cells with few samples are lumped together with the absorbed ones.
            double chi_square = 0.0, rest_expected = kSamples * (1.0 - total), rest = absorbed;
            int degrees = 0;
            for (std::size_t i = 0; i < counts.size(); ++i) {
                const double e = expected[i] * kSamples;
                if (e < 50.0) {
                    rest_expected += e;
                    rest += counts[i];
                } else {
                    chi_square += (counts[i] - e) * (counts[i] - e) / e;
                    ++degrees;
                }
            }
            if (rest_expected >= 50.0) {
                chi_square += (rest - rest_expected) * (rest - rest_expected) / rest_expected;
                ++degrees;
            }
            CHECK(statistics::p_of_chi_square(chi_square, degrees - 1) > statistics::least_p());
        }
    }
}

TEST_CASE("BSDF samples carry the weight and the density that evaluate() gives") {
    for (const Case& c : cases()) {
        for (const V3f& view : views()) {
            CAPTURE(c.name);
            const Bsdf bsdf = c.towards(view);
            RandomStream random(1);
            for (int i = 0; i < 1000; ++i) {
                const float lobe = random.next();
                const float x = random.next();
                const BsdfSample s = bsdf.sample(lobe, V2f(x, random.next()));
                if (s.pdf == 0.0f) continue;
                const BsdfValue v = bsdf.evaluate(s.direction);
                CHECK(s.direction.length() == doctest::Approx(1.0).scale(0.0).epsilon(1e-5));
                CHECK(v.pdf == doctest::Approx(s.pdf).scale(0.0).epsilon(1e-3));
                CHECK(v.value.y == doctest::Approx(s.weight.y * s.pdf).scale(0.0).epsilon(1e-3));
            }
        }
    }
}

TEST_CASE("BSDFs are reciprocal and reflect no more than they receive") {
    for (const Case& c : cases()) {
        CAPTURE(c.name);
        RandomStream random(3);
        for (int i = 0; i < 1000; ++i) {
            const float cosine_a = 0.02f + 0.98f * random.next();
            const float cosine_b = 0.02f + 0.98f * random.next();
            const V3f a = direction(cosine_a, 6.0f * random.next());
            const V3f b = direction(cosine_b, 6.0f * random.next());
            const V3f ab = c.towards(a).evaluate(b).value / b.z;
            const V3f ba = c.towards(b).evaluate(a).value / a.z;
            CHECK(ab.x == doctest::Approx(ba.x).scale(0.0).epsilon(1e-4));
            CHECK(ab.z == doctest::Approx(ba.z).scale(0.0).epsilon(1e-4));
        }
        for (const V3f& view : views()) {
            const Bsdf bsdf = c.towards(view);
            double reflected = 0.0;
            constexpr int kSamples = 20000;
            for (int i = 0; i < kSamples; ++i) {
                const float lobe = random.next();
                const float x = random.next();
                const V3f weight = bsdf.sample(lobe, V2f(x, random.next())).weight;
                reflected += static_cast<double>(weight.x) / kSamples;
            }
            CHECK(reflected <= 1.01);
        }
    }
}

TEST_CASE("a BSDF is 0 below the surface, and a roughness of 0 is a mirror") {
    const V3f view = direction(0.6f, 1.0f);
    for (const Case& c : cases()) {
        const BsdfValue below = c.towards(view).evaluate(direction(-0.3f, 0.5f));
        CHECK(below.pdf == 0.0f);
        CHECK(below.value == V3f(0.0f));
    }
    const Bsdf mirror = Bsdf::metallic_roughness(kUp, view, V3f(0.9f, 0.8f, 0.7f), 1.0f, 0.0f);
    RandomStream random(5);
    for (int i = 0; i < 100; ++i) {
        const float x = random.next();
        const BsdfSample s = mirror.sample(0.5f, V2f(x, random.next()));
        // Of 100 normals of GGX with alpha 0.001 none is likely to be further off than 0.05.
        CHECK((s.direction - V3f(-view.x, -view.y, view.z)).length() < 0.1f);
        CHECK(s.weight.y == doctest::Approx(0.8 + 0.2 * std::pow(0.4, 5)).scale(0.0).epsilon(0.01));
    }
}

TEST_CASE("the parts that light samplers are told of are the BSDF in the mirror direction") {
    for (const Case& c : cases()) {
        for (const V3f& outgoing : views()) {
            CAPTURE(c.name);
            CAPTURE(outgoing.z);
            const Bsdf bsdf = c.towards(outgoing);
            const lightcull::GlossyLobe lobe = bsdf.glossy_part();
            CHECK((lobe.peak > 0.0f) == !c.is_diffuse);
            const auto estimate = [&](const V3f& incoming) {
                const float along = incoming.dot(lightcull::to_v3f(lobe.axis));
                const float fall = 1.0f + (1.0f - along) / (2.0f * lobe.alpha * lobe.alpha);
                return bsdf.diffuse_part() * incoming.z + lobe.peak / (fall * fall);
            };
            const auto truth = [&](const V3f& incoming) {
                return lightcull::luminance(bsdf.evaluate(incoming).value);
            };
            const V3f mirrored(-outgoing.x, -outgoing.y, outgoing.z);
            CHECK(estimate(mirrored) == doctest::Approx(truth(mirrored)).scale(0.0).epsilon(1e-3));
            // Seen from above, where masking and cosines change little, the estimate also holds
            // around the mirrored direction.
            if (outgoing.z < 1.0f) continue;
            for (const float tilt : {0.05f, 0.2f, 0.4f}) {
                const V3f aside(std::sin(tilt), 0.0f, std::cos(tilt));
                CHECK(estimate(aside) > 0.8f * truth(aside));
                CHECK(estimate(aside) < 1.25f * truth(aside));
            }
        }
    }
}
