#include <doctest/doctest.h>
#include <lightcull/triangle_cuts.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/random.h"
#include "lanes/cut_walk.h"
#include "scene/emission_lattice.h"
#include "scene/lit_distances.h"
#include "scene/triangle_places.h"
#include "unit/statistics.h"

using namespace lightcull;
using mitsuba::culling::EmissionLattice;
using mitsuba::culling::LitDistances;
using mitsuba::culling::TrianglePlaces;
using mitsuba::culling::WeightsInNode;

namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

/// A lattice of what a function of barycentric coordinates gives.
template <typename Function>
EmissionLattice lattice_of(std::uint32_t size, const Function& radiance, float least = 0.0f) {
    std::vector<float> radiances;
    for (const bool is_corner : {false, true}) {
        const std::uint32_t edge = is_corner ? size + 1 : size;
        const float offset = is_corner ? 0.0f : EmissionLattice::kOffset;
        for (std::uint32_t row = 0; row < edge; ++row) {
            for (std::uint32_t column = 0; column < edge; ++column) {
                float2 at{(static_cast<float>(column) + offset) / static_cast<float>(size),
                          (static_cast<float>(row) + offset) / static_cast<float>(size)};
                if (at.x + at.y > 1.0f) at = {1.0f - at.x, 1.0f - at.y};
                radiances.push_back(radiance(at));
            }
        }
    }
    REQUIRE(radiances.size() == EmissionLattice::count(size));
    return {size, radiances, least};
}

/// A texel of 64 x 64 in the half of a square that the corners (0, 0), (1, 0) and (1, 1) span, as
/// its neighbours are blended with it, or not.
float tent(float2 at) {
    const float x = 64.0f * (at.x + at.y) - 40.5f, y = 64.0f * at.y - 20.5f;
    return std::max(0.0f, 1.0f - std::fabs(x)) * std::max(0.0f, 1.0f - std::fabs(y));
}
float box(float2 at) {
    const float x = 64.0f * (at.x + at.y) - 40.0f, y = 64.0f * at.y - 20.0f;
    return x >= 0.0f && x < 1.0f && y >= 0.0f && y < 1.0f ? 1.0f : 0.0f;
}

const TriangleCorners kHalf{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};

TrianglePlaces places_of(const EmissionLattice& lattice) {
    CutDemand demand;
    demand.emission = [&](std::uint32_t, const SubTriangle& part) { return lattice.over(part); };
    demand.distance = [](std::uint32_t, const SubTriangle&) { return kFar; };
    const std::vector<TriangleCorners> triangles{kHalf};
    TriangleCuts cuts(triangles, demand);
    TrianglePlaces places;
    for (std::size_t i = 0; i < cuts.parts().size(); ++i) places.add(0.5f);
    const auto count = static_cast<std::uint32_t>(cuts.parts().size());
    places.take(std::move(cuts));
    places.set_triangle(0, 0);
    for (std::uint32_t i = 0; i < count; ++i) places.set_part(i, i);
    return places;
}

}  // namespace

TEST_CASE("plugin cuts: a texel is found, and drawn with hardly any variance") {
    for (const auto radiance : {tent, box}) {
        const TrianglePlaces places = places_of(lattice_of(256, radiance));
        REQUIRE(places.cuts().parts().size() == 1);
        CHECK(area_share(places.cuts().parts()[0].corners) < 0.05f);
        RandomStream random(3);
        statistics::Accumulator draws;
        int found_again = 0;
        constexpr int kDraws = 20000;
        for (int i = 0; i < kDraws; ++i) {
            const auto piece = static_cast<double>(random.next());
            const float u = random.next();
            const auto [uv, density] = places.draw(0, piece, u, random.next());
            draws.add(64.0 * 64.0 * static_cast<double>(radiance(uv) / density));
            const float again = places.find(0, uv).density;
            // At edges of pieces rounding decides.
            if (std::fabs(again / density - 1.0f) < 1e-2f) ++found_again;
        }
        CHECK(found_again > 0.99 * kDraws);
        const statistics::Estimate estimate = draws.estimate();
        CHECK(estimate.mean == doctest::Approx(1.0).epsilon(0.01));
        CHECK(kDraws * estimate.variance < 0.006);
    }
    CHECK(places_of(lattice_of(8, [](float2) { return 0.0f; })).cuts().parts()[0].radiance == 0.0f);
}

TEST_CASE("plugin cuts: the mean over parts is that of the lattice, which may miss some") {
    const auto ramp = [](float2 at) { return 1.0f + at.x; };
    const EmissionLattice lattice = lattice_of(64, ramp);
    const SubTriangle whole{}, half = half_of(whole, 0, true), quarter = half_of(half, 1, false);
    for (const SubTriangle& part : {whole, half, quarter}) {
        const float2 middle = place_in(part, {1.0f / 3.0f, 1.0f / 3.0f});
        CHECK(lattice.over(part).mean == doctest::Approx(ramp(middle)).epsilon(0.01));
    }
    CHECK(lattice.over(whole).unevenness > 0.02f);
    const auto step = [](float2 at) { return at.x < 0.25f ? 1.0f : 0.0f; };
    const SubTriangle dark{{{0.5f, 0.0f}, {1.0f, 0.0f}, {0.5f, 0.5f}}};
    CHECK(lattice_of(16, step).over(dark).mean == 0.0f);
    CHECK(lattice_of(16, step, 0.01f).over(dark).mean > 0.003f);
}

TEST_CASE(
    "plugin cuts: a place that is no part of a light is not drawn; whole triangles are even") {
    const TrianglePlaces places = places_of(lattice_of(128, box));
    CHECK(places.find(0, {0.1f, 0.8f}).density == 0.0f);
    TrianglePlaces whole;
    whole.add(0.5f);
    CHECK_FALSE(whole.has_parts());
    CHECK(whole.find(0, {0.1f, 0.8f}).density == 2.0f);
    const TrianglePlaces::Place place = whole.draw(0, 0.0, 0.25f, 0.5f);
    CHECK(place.density == 2.0f);
    CHECK(place.uv.x == 0.25f);
    CHECK(place.uv.y == 0.25f);
}

TEST_CASE("plugin cuts: kernels find and draw places as the processor does") {
    const TrianglePlaces places = places_of(lattice_of(64, tent));
    const auto select = [](bool condition, float a, float b) { return condition ? a : b; };
    const auto nodes = places.cuts().nodes();
    RandomStream random(8);
    for (int i = 0; i < 5000; ++i) {
        float2 at{random.next(), random.next()};
        if (at.x + at.y > 1.0f) at = {1.0f - at.x, 1.0f - at.y};
        WeightsInNode<float> weights{{1.0f - at.x - at.y, at.x, at.y}};
        std::uint32_t node = 0;
        while (nodes[node].first_child != 0) {
            const bool second = weights.step(nodes[node].edge, select);
            node = nodes[node].first_child + (second ? 1 : 0);
        }
        const auto [piece, place] = places.cuts().at(0, at);
        CHECK(weights.of[1] == place.x);
        CHECK(weights.of[2] == place.y);

        const TriangleCuts::Piece uneven{0, 1.0f, {}, {0.2f, 0.5f, 0.3f}};
        const float2 expected = TriangleCuts::draw_place(uneven, at.x, at.y);
        const auto drawn = mitsuba::culling::draw_linear(uneven.weights, at.x, at.y, select);
        CHECK(drawn.of[1] == doctest::Approx(expected.x).epsilon(1e-4));
        CHECK(drawn.of[2] == doctest::Approx(expected.y).epsilon(1e-4));
        CHECK(drawn.of[0] + drawn.of[1] + drawn.of[2] == doctest::Approx(1.0));
    }
}

TEST_CASE("plugin cuts: distances are those of the rays that have left a part, or next to it") {
    std::vector<LitDistances::Ray> rays;
    RandomStream random(2);
    for (int i = 0; i < 2000; ++i) {
        float2 from{random.next(), random.next()};
        if (from.x + from.y > 1.0f) from = {1.0f - from.x, 1.0f - from.y};
        rays.push_back({from, random.next() < 0.5f ? kFar : 1.0f + 10.0f * from.x});
    }
    const LitDistances distances(rays);
    // A quarter of the rays of all are nearer than where (1 - x)^2 = 3 / 4.
    CHECK(distances.from({}) == doctest::Approx(2.34).epsilon(0.15));
    SubTriangle part{};
    for (int i = 0; i < 6; ++i) part = half_of(part, i % 2 == 0 ? 1 : 0, false);
    const float2 middle = place_in(part, {1.0f / 3.0f, 1.0f / 3.0f});
    CHECK(distances.from(part) == doctest::Approx(1.0f + 10.0f * middle.x).epsilon(0.3));
    CHECK(LitDistances({{{0.2f, 0.2f}, kFar}}).from({}) == kFar);
}
