#include <doctest/doctest.h>
#include <lightcull/light_sampler.h>

#include <algorithm>
#include <set>
#include <vector>

#include "base/alias_table.h"
#include "base/random.h"
#include "base/reservoir.h"
#include "lights/ranges/pattern.h"
#include "lights/ranges/ranges.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

TEST_CASE("every rotation occurs once in the pattern, and neighbours are far apart") {
    for (std::uint32_t log4 = 0; log4 <= 6; ++log4) {
        const std::uint32_t sets = 1u << (2 * log4), side = 1u << log4;
        std::set<std::uint32_t> ranks;
        for (std::uint32_t set = 0; set < sets; ++set) {
            const std::uint32_t rank = rank_of_set(set, log4);
            ranks.insert(rank);
            CHECK(set_of_rank(rank, log4) == set);
        }
        CHECK(ranks.size() == sets);
        CHECK(*ranks.rbegin() == sets - 1);
        for (std::uint32_t x = 0; log4 > 0 && x + 1 < side; ++x) {
            const auto a = static_cast<int>(rank_of_set(set_of_pixel(x, 1, sets), log4));
            const auto b = static_cast<int>(rank_of_set(set_of_pixel(x + 1, 1, sets), log4));
            const int apart = std::abs(a - b);
            CHECK(std::min(apart, static_cast<int>(sets) - apart) * 4 >= static_cast<int>(sets));
        }
    }
}

TEST_CASE("packets go round sixteen evenly spread rotations") {
    for (const std::uint32_t sets : {1u, 4u, 16u, 64u, 256u}) {
        const std::uint32_t log4 = log4_of(sets), used = std::min(sets, 16u);
        std::set<std::uint32_t> ranks;
        for (std::uint32_t packet = 0; packet < 64; ++packet) {
            ranks.insert(rank_of_set(set_of_packet(packet, sets), log4));
        }
        CHECK(ranks.size() == used);
        for (const std::uint32_t rank : ranks) CHECK(rank % (sets / used) == 0);
    }
}

TEST_CASE("xi is uniform, above 0, and rotated from set to set") {
    constexpr std::uint32_t kSets = 16, kLights = 100000;
    RandomRanges ranges(1.0f, kSets);
    ranges.begin_pass(5);
    std::vector<int> bins(64);
    for (std::uint32_t light = 0; light < kLights; ++light) {
        const float first = ranges.xi(light, set_of_rank(0, 2));
        ++bins[std::min(static_cast<std::size_t>(first * 64.0f), std::size_t{63})];
        for (std::uint32_t rank = 0; rank < kSets; ++rank) {
            const float xi = ranges.xi(light, set_of_rank(rank, 2));
            REQUIRE(xi > 0.0f);
            REQUIRE(xi <= 1.0f);
            float expected = first + static_cast<float>(rank) / kSets;
            if (expected > 1.0f) expected -= 1.0f;
            const float apart = std::abs(xi - expected);
            REQUIRE(std::min(apart, 1.0f - apart) < 1e-6f);
        }
    }
    double chi2 = 0.0;
    for (const int n : bins) chi2 += (n - kLights / 64.0) * (n - kLights / 64.0) / (kLights / 64.0);
    CHECK(chi2 < 120.0);  // 63 degrees of freedom: false alarm below 2e-5
    ranges.begin_pass(6);
    RandomRanges other(1.0f, kSets);
    other.begin_pass(5);
    int equal = 0;
    for (std::uint32_t light = 0; light < 1000; ++light) {
        equal += ranges.xi(light, 0) == other.xi(light, 0);
    }
    CHECK(equal < 5);  // passes are independent
}

TEST_CASE("small numbers occur as often as they should") {
    RandomRanges ranges(1.0f, 1);
    constexpr std::uint32_t kLights = 1u << 22;
    std::uint32_t below = 0;
    for (std::uint64_t pass = 0; pass < 4; ++pass) {
        ranges.begin_pass(pass);
        for (std::uint32_t light = 0; light < kLights; ++light) {
            below += ranges.xi(light, 0) < 0x1p-16f;
        }
    }
    const double expected = 4.0 * kLights * 0x1p-16;
    CHECK(std::abs(below - expected) < 5.0 * std::sqrt(expected));  // false alarm 6e-7
}

TEST_CASE("the reservoir chooses in proportion to weight") {
    for (const std::uint32_t count : {1u, 5u, 64u, 65u, 300u}) {
        constexpr int kDraws = 200000;
        std::vector<int> chosen(count);
        double total = 0.0;
        for (std::uint32_t i = 0; i < count; ++i) total += 1.0 + i % 7;
        for (int draw = 0; draw < kDraws; ++draw) {
            Reservoir reservoir(uniform_float(hash(static_cast<std::uint64_t>(draw), 11)));
            for (std::uint32_t i = 0; i < count; ++i) {
                reservoir.add(i, 2.0f, 1.0f + static_cast<float>(i % 7));
            }
            REQUIRE(reservoir.chosen());
            REQUIRE(reservoir.prob() * reservoir.weight_sum() == doctest::Approx(2.0));
            ++chosen[reservoir.light()];
            if (draw == 0) CHECK(reservoir.weight_sum() == doctest::Approx(total));
        }
        const double limit = sidak_z(1e-6, count);
        for (std::uint32_t i = 0; i < count; ++i) {
            const double p = (1.0 + i % 7) / total;
            const double sigma = std::sqrt(kDraws * p * (1 - p)) + 1e-9;
            CHECK(std::abs(chosen[i] - kDraws * p) <= limit * sigma);
        }
    }
}

TEST_CASE("the alias table draws by weight, and never what weighs nothing") {
    std::vector<double> weights;
    double total = 0.0;
    for (int i = 0; i < 100; ++i) {
        weights.push_back(i % 3 == 0 ? 0.0 : i);
        total += weights.back();
    }
    const AliasTable table(weights);
    std::vector<int> drawn(weights.size());
    constexpr int kDraws = 1 << 20;
    for (int i = 0; i < kDraws; ++i) ++drawn[table.sample((i + 0.5) / kDraws)];
    for (std::uint32_t i = 0; i < weights.size(); ++i) {
        CHECK(table.prob(i) == doctest::Approx(weights[i] / total));
        if (weights[i] == 0.0) CHECK(drawn[i] == 0);
        // Evenly spaced numbers miss a column by at most one at each of its ends.
        CHECK(std::abs(drawn[i] - kDraws * weights[i] / total) <= 200.0);
    }
}
