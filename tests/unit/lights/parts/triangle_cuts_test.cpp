#include <lightcull/triangle_cuts.h>

#include "base/random.h"
#include "unit/statistics.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

using namespace lightcull;

namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

const TriangleCorners kStrip{{0, 3, 0}, {30, 3, 0}, {30, 3, 0.1f}};
const TriangleCorners kWide{{0, 0, 0}, {4, 0, 0}, {1, 3, 1}};

/// Triangles that emit the same everywhere, and are cut until they are not longer than `distance`.
CutDemand even(float distance) {
    CutDemand demand;
    demand.emission = [](std::uint32_t, const SubTriangle&) {
        PartEmission emission;
        emission.mean = 2.0f;
        return emission;
    };
    demand.distance = [distance](std::uint32_t, const SubTriangle&) { return distance; };
    return demand;
}

float2 middle(const SubTriangle& part) {
    return place_in(part, {1.0f / 3.0f, 1.0f / 3.0f});
}

/// What is emitted at a place: beyond a line near the second corner nothing (where this is below
/// 0), and towards the corner more and more.
double ramp(float2 place) {
    const double x = static_cast<double>(place.x), y = static_cast<double>(place.y);
    return 0.3 - (1.0 - x - y) - y;
}

/// The integral of what is emitted over a triangle of area 1: that of a pyramid.
constexpr double kFlux = 2.0 * 0.3 * 0.3 * 0.3 / 6.0;

/// The mean over a triangle of a linear function of these values at its corners, where it is above
/// 0.
double mean_above_0(double a, double b, double c) {
    if (a < b) std::swap(a, b);
    if (b < c) std::swap(b, c);
    if (a < b) std::swap(a, b);
    if (a <= 0.0) return 0.0;
    if (c >= 0.0) return (a + b + c) / 3.0;
    if (b <= 0.0) return a / 3.0 * (a / (a - b)) * (a / (a - c));
    return (a + b + c) / 3.0 + mean_above_0(-a, -b, -c);
}

/// The mean of f over a sub-triangle.
template <typename Function>
double mean_over(const SubTriangle& part, const Function& f) {
    constexpr int kSteps = 24;
    double sum = 0.0;
    const auto add = [&](double i, double j) {
        const float2 place{static_cast<float>(i / kSteps), static_cast<float>(j / kSteps)};
        sum += f(place_in(part, place));
    };
    for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; i + j < kSteps; ++j) {
            add(i + 1.0 / 3.0, j + 1.0 / 3.0);
            if (i + j + 1 < kSteps) add(i + 2.0 / 3.0, j + 2.0 / 3.0);
        }
    }
    return sum / (kSteps * kSteps);
}

/// Triangles that emit ramp(), with linear densities within pieces or even ones.
CutDemand uneven(float distance, bool linear) {
    CutDemand demand = even(distance);
    demand.emission = [linear](std::uint32_t, const SubTriangle& part) {
        PartEmission emission;
        const auto value = [](float2 at) { return std::max(0.0, ramp(at)); };
        const auto& corners = part.corners;
        const double mean = mean_above_0(ramp(corners[0]), ramp(corners[1]), ramp(corners[2]));
        emission.mean = static_cast<float>(mean);
        if (!(emission.mean > 0.0f)) return emission;
        double densities[3]{1.0, 1.0, 1.0};
        for (int i = 0; linear && i < 3; ++i) {
            densities[i] = std::max(value(corners[i]), 0.05 * mean);
            emission.densities[i] = static_cast<float>(densities[i]);
        }
        const float2 o = part.corners[0], p = part.corners[1], q = part.corners[2];
        const double area = static_cast<double>(area_share(part));
        const double third = (densities[0] + densities[1] + densities[2]) / 3.0;
        const auto square_over_density = [&](float2 at) {
            const double x = (static_cast<double>(at.x - o.x) * static_cast<double>(q.y - o.y) -
                              static_cast<double>(at.y - o.y) * static_cast<double>(q.x - o.x)) /
                             area;
            const double y = (static_cast<double>(p.x - o.x) * static_cast<double>(at.y - o.y) -
                              static_cast<double>(p.y - o.y) * static_cast<double>(at.x - o.x)) /
                             area;
            const double density =
                (densities[0] * (1.0 - x - y) + densities[1] * x + densities[2] * y) / third;
            return value(at) * value(at) / density;
        };
        emission.unevenness =
            static_cast<float>(mean_over(part, square_over_density) / (mean * mean) - 1.0);
        return emission;
    };
    return demand;
}

bool holds(const SubTriangle& part, float2 place, float slack) {
    const auto [o, p, q] = part.corners;
    const float area = area_share(part);
    const float x = (place.x - o.x) * (q.y - o.y) - (place.y - o.y) * (q.x - o.x);
    const float y = (p.x - o.x) * (place.y - o.y) - (p.y - o.y) * (place.x - o.x);
    return std::min({x, y, area - x - y}) > -slack * area;
}

double longest_edge(const TriangleCorners& t, const SubTriangle& part) {
    double longest = 0.0;
    const auto position = [&](float2 b, float a, float at_b, float at_c) {
        return static_cast<double>(a * (1.0f - b.x - b.y) + at_b * b.x + at_c * b.y);
    };
    for (int i = 0; i < 3; ++i) {
        const float2 from = part.corners[i], to = part.corners[(i + 1) % 3];
        const double x = position(from, t.a.x, t.b.x, t.c.x) - position(to, t.a.x, t.b.x, t.c.x);
        const double y = position(from, t.a.y, t.b.y, t.c.y) - position(to, t.a.y, t.b.y, t.c.y);
        const double z = position(from, t.a.z, t.b.z, t.c.z) - position(to, t.a.z, t.b.z, t.c.z);
        longest = std::max(longest, std::sqrt(x * x + y * y + z * z));
    }
    return longest;
}

}  // namespace

TEST_CASE("triangle cuts: what is near to all that it lights, and even, stays whole") {
    for (const float distance : {kFar, 31.0f}) {
        const std::vector<TriangleCorners> triangles{kStrip, kWide};
        const TriangleCuts cuts(triangles, even(distance));
        REQUIRE(cuts.parts().size() == 2);
        for (const std::uint32_t i : {0u, 1u}) {
            CHECK_FALSE(cuts.is_cut(i));
            CHECK(cuts.parts()[i].triangle == i);
            CHECK(cuts.parts()[i].radiance == 2.0f);
            const TriangleCuts::Found found = cuts.at(i, {0.2f, 0.7f});
            CHECK(found.piece.part == i);
            CHECK(found.piece.prob == 1.0f);
            CHECK(found.place.x == 0.2f);
            CHECK(found.place.y == 0.7f);
        }
    }
}

TEST_CASE("triangle cuts: parts tile their triangle, and are no longer than was asked for") {
    for (const float distance : {3.0f, 1.0f}) {
        const std::vector<TriangleCorners> triangles{kStrip, kWide, kStrip};
        const TriangleCuts cuts(triangles, even(distance));
        std::vector<double> areas(triangles.size());
        for (const TriangleCuts::Part& part : cuts.parts()) {
            CHECK(area_share(part.corners) > 0.0f);
            areas[part.triangle] += static_cast<double>(area_share(part.corners));
            // A sliver's tip may be longer, as it emits next to nothing.
            const bool is_tip = area_share(part.corners) <= 1.0f / 256.0f;
            CHECK((is_tip ||
                   longest_edge(triangles[part.triangle], part.corners) <= 1.0001 * distance));
            CHECK(part.radiance == 2.0f);
        }
        for (const double area : areas) CHECK(area == 1.0);  // powers of 2, which are exact
        RandomStream random(3);
        for (int i = 0; i < 20000; ++i) {
            const auto triangle = static_cast<std::uint32_t>(i % 3);
            float2 place{random.next(), random.next()};
            if (place.x + place.y > 1.0f) place = {1.0f - place.x, 1.0f - place.y};
            const TriangleCuts::Found found = cuts.at(triangle, place);
            REQUIRE(found.piece.part < cuts.parts().size());
            const TriangleCuts::Part& part = cuts.parts()[found.piece.part];
            CHECK(part.triangle == triangle);
            CHECK(holds(part.corners, place, 1e-4f));
            const float2 again = place_in(part.corners, found.place);
            CHECK(std::hypot(again.x - place.x, again.y - place.y) < 1e-6f);
        }
    }
}

TEST_CASE("triangle cuts: a place on an edge is in some part next to it") {
    const std::vector<TriangleCorners> triangles{kStrip};
    const TriangleCuts cuts(triangles, even(1.0f));
    REQUIRE(cuts.parts().size() > 30);
    for (const TriangleCuts::Part& part : cuts.parts()) {
        for (int i = 0; i < 3; ++i) {
            const float2 a = part.corners.corners[i], b = part.corners.corners[(i + 1) % 3];
            for (const float along : {0.0f, 0.25f, 0.5f, 0.7f}) {
                const float2 place{a.x + (b.x - a.x) * along, a.y + (b.y - a.y) * along};
                const std::uint32_t found = cuts.at(0, place).piece.part;
                REQUIRE(found < cuts.parts().size());
                CHECK(holds(cuts.parts()[found].corners, place, 1e-4f));
            }
        }
    }
}

TEST_CASE("triangle cuts: there are no more lights and pieces than may be") {
    const std::vector<TriangleCorners> triangles{kStrip, kWide};
    CutDemand demand = even(0.5f);
    demand.most_lights = 7;
    CHECK(TriangleCuts(triangles, demand).parts().size() == 9);
    demand.least_flux = 2.0 * 1.5 * 1.001;  // all that the strip emits
    CHECK_FALSE(TriangleCuts(triangles, demand).is_cut(0));
    CHECK(TriangleCuts(triangles, demand).is_cut(1));

    demand = uneven(kFar, false);
    demand.most_pieces = 100;
    const std::size_t few = TriangleCuts(triangles, demand).memory_size();
    demand.most_pieces = 1000;
    CHECK(TriangleCuts(triangles, demand).memory_size() > 5 * few);
    demand.least_flux = 100.0;
    CHECK_FALSE(TriangleCuts(triangles, demand).is_cut(0));
}

TEST_CASE("triangle cuts: an edge that touches what it lights is not cut for ever") {
    const std::vector<TriangleCorners> triangles{kWide};
    CutDemand demand = even(0.0f);
    demand.distance = [](std::uint32_t, const SubTriangle& part) { return middle(part).x; };
    const TriangleCuts cuts(triangles, demand);
    CHECK(cuts.parts().size() < 300);
    for (const TriangleCuts::Part& part : cuts.parts()) {
        CHECK(area_share(part.corners) > 1.0f / 1024.0f);
    }
}

TEST_CASE("triangle cuts: where nothing is emitted there is no part, and lights are where it is") {
    const std::vector<TriangleCorners> triangles{kWide, kWide};
    CutDemand demand = uneven(kFar, true);
    const auto of_ramp = demand.emission;
    demand.emission = [&](std::uint32_t i, const SubTriangle& part) {
        return i == 0 ? PartEmission{} : of_ramp(i, part);
    };
    const TriangleCuts cuts(triangles, demand);
    REQUIRE(cuts.parts().size() == 2);
    CHECK(cuts.parts()[0].radiance == 0.0f);
    CHECK(cuts.at(1, {0.1f, 0.1f}).piece.part == TriangleCuts::kNoPart);
    CHECK(cuts.at(1, {0.9f, 0.05f}).piece.part == 1);
    const TriangleCuts::Part& lit = cuts.parts()[1];
    CHECK(area_share(lit.corners) < 1.0f);
    const double flux =
        static_cast<double>(lit.radiance) * static_cast<double>(area_share(lit.corners));
    CHECK(flux == doctest::Approx(kFlux).epsilon(1e-6));
}

TEST_CASE("triangle cuts: pieces are drawn as at() has them, and estimate what is emitted") {
    const std::vector<TriangleCorners> triangles{kWide};
    for (const bool linear : {false, true}) {
        for (const float distance : {kFar, 2.0f}) {
            CAPTURE(linear);
            CAPTURE(distance);
            const TriangleCuts cuts(triangles, uneven(distance, linear));
            RandomStream random(9);
            double flux = 0.0;
            statistics::Estimate sum;
            for (std::uint32_t part = 0; part < cuts.parts().size(); ++part) {
                statistics::Accumulator of_part;
                for (int i = 0; i < 4000; ++i) {
                    const auto number = static_cast<double>(random.next());
                    const TriangleCuts::Piece piece = cuts.draw(part, number);
                    const float u = random.next();
                    const float2 b = TriangleCuts::draw_place(piece, u, random.next());
                    REQUIRE(std::min({b.x, b.y, 1.0f - b.x - b.y}) > -1e-6f);
                    const float2 place = place_in(piece.corners, b);
                    const float density =
                        TriangleCuts::density(piece, b) * piece.prob / area_share(piece.corners);
                    of_part.add(std::max(0.0, ramp(place)) / static_cast<double>(density));
                    // Not right at an edge, where rounding decides.
                    if (std::min({b.x, b.y, 1.0f - b.x - b.y}) < 1e-3f) continue;
                    const auto [found, again] = cuts.at(0, place);
                    REQUIRE(found.part == part);
                    REQUIRE(found.prob == doctest::Approx(piece.prob).epsilon(1e-5));
                    REQUIRE(TriangleCuts::density(found, again) ==
                            doctest::Approx(TriangleCuts::density(piece, b)).epsilon(1e-2));
                }
                const statistics::Estimate estimate = of_part.estimate();
                const double exact = static_cast<double>(cuts.parts()[part].radiance) *
                                     static_cast<double>(area_share(cuts.parts()[part].corners));
                sum.mean += estimate.mean;
                sum.variance += estimate.variance;
                flux += exact;
                // So little is left of the variance, which is some 3 where places are uniform.
                CHECK(4000.0 * estimate.variance < 0.01 * exact * exact);
            }
            CHECK(flux == doctest::Approx(kFlux).epsilon(1e-6));
            // The linear ones have no variance to speak of, and rounding is what is left.
            if (std::fabs(sum.mean / kFlux - 1.0) < 1e-6) continue;
            CHECK(statistics::p_of_z(statistics::z_of(sum, {kFlux, 0.0})) > statistics::least_p());
        }
    }
}

TEST_CASE("triangle cuts: each of many pieces is drawn as often as it says") {
    // 24 bits would be off by a percent.
    const std::vector<TriangleCorners> triangles{kWide};
    CutDemand demand = even(kFar);
    demand.emission = [](std::uint32_t, const SubTriangle& part) {
        PartEmission emission;
        const float2 at = middle(part);
        emission.mean = 1.0f + at.x;
        emission.unevenness = 1.0f;
        return emission;
    };
    demand.most_pieces = 30000;
    const TriangleCuts cuts(triangles, demand);
    REQUIRE(cuts.parts().size() == 1);
    const auto is_drawn = [&](const TriangleCuts::Piece& piece, double u) {
        const TriangleCuts::Piece other = cuts.draw(0, u);
        return std::equal(piece.corners.corners, piece.corners.corners + 3, other.corners.corners,
                          [](float2 a, float2 b) { return a.x == b.x && a.y == b.y; });
    };
    /// The end of the numbers that draw the piece, on the way from one that does to one that does
    /// not.
    const auto end_of = [&](const TriangleCuts::Piece& piece, double inside, double outside) {
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (inside + outside);
            (is_drawn(piece, middle) ? inside : outside) = middle;
        }
        return inside;
    };
    RandomStream random(5);
    for (int i = 0; i < 100; ++i) {
        const auto u = 0.01 + 0.98 * static_cast<double>(random.next());
        const TriangleCuts::Piece piece = cuts.draw(0, u);
        REQUIRE(piece.prob < 1e-3f);
        const double length = end_of(piece, u, 1.0) - end_of(piece, u, 0.0);
        CHECK(length == doctest::Approx(static_cast<double>(piece.prob)).epsilon(1e-4));
    }
}

TEST_CASE("cut limits: what is dim beside all others is not worth a cut, the brightest apart") {
    std::vector<Light> lights(10000, point_light({0, 0, 0}, 1.0f));
    std::fill_n(lights.begin(), 20, point_light({0, 0, 0}, 1e9f));
    lights.push_back(directional_light({0, -1, 0}, 1e9f));
    const CutLimits limits = cut_limits(lights);
    CHECK(limits.least_flux == doctest::Approx((10000.0 - 16.0 - 39.0) / 1024.0).epsilon(1e-6));
    CHECK(limits.most_lights == 4096);
    lights.resize(16);
    CHECK(cut_limits(lights).least_flux == 0.0);
}
