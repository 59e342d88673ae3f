#include <doctest/doctest.h>
#include <lightcull/sets.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "base/alias_table.h"
#include "base/random.h"
#include "base/reservoir.h"
#include "lights/ranges/pattern.h"
#include "lights/ranges/ranges.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

TEST_CASE("every rotation occurs once in the pattern") {
    for (std::uint32_t log4 = 0; log4 <= 6; ++log4) {
        const std::uint32_t sets = 1u << (2 * log4);
        const SetPattern pattern(sets);
        CHECK(pattern.rotations() == std::min(sets, 256u));
        CHECK(pattern.rotations() * pattern.draws() == sets);
        std::set<std::pair<std::uint32_t, std::uint32_t>> places;
        for (std::uint32_t set = 0; set < sets; ++set) {
            const std::uint32_t rank = pattern.rank_of(set), draw = pattern.draw_of(set);
            CHECK(rank < pattern.rotations());
            CHECK(draw < pattern.draws());
            places.insert({rank, draw});
            CHECK(pattern.set_of(rank, draw) == set);
        }
        CHECK(places.size() == sets);
    }
}

namespace {

/// Whether the pixels of the square at (x, y) take evenly spread rotations of one draw, neighbours
/// at least a quarter of a turn apart.
bool is_dithered(std::uint32_t x, std::uint32_t y, std::uint32_t edge, std::uint64_t pass,
                 std::uint32_t sets) {
    const SetPattern pattern(sets);
    const std::uint32_t turns = pattern.rotations(), width = turns / (edge * edge);
    const auto set_at = [&](std::uint32_t i) {
        return set_of_pixel(x + i % edge, y + i / edge, pass, sets);
    };
    std::set<std::uint32_t> places, draws;
    for (std::uint32_t i = 0; i < edge * edge; ++i) {
        const std::uint32_t rank = pattern.rank_of(set_at(i));
        const std::uint32_t turn = (rank - pattern.rank_of(set_at(0))) & (turns - 1);
        if (turn % width != 0) return false;
        places.insert(turn / width);
        draws.insert(pattern.draw_of(set_at(i)));
        if (i % edge == 0) continue;
        const std::uint32_t apart = (rank - pattern.rank_of(set_at(i - 1))) & (turns - 1);
        if (std::min(apart, turns - apart) * 4 < turns) return false;
    }
    return places.size() == std::size_t{edge} * edge && draws.size() == 1;
}

}  // namespace

TEST_CASE("the pixels of a square take evenly spread rotations, in each pass other squares") {
    for (const std::uint32_t sets : {4u, 16u, 64u, 256u, 1024u}) {
        const std::uint32_t edge = sets == 4 ? 2 : 4;
        std::set<std::uint32_t> starts;
        for (std::uint64_t pass = 0; pass < 64; ++pass) {
            // There is a place from which squares on are all dithered.
            std::uint32_t found = edge * edge;
            for (std::uint32_t start = 0; start < edge * edge && found == edge * edge; ++start) {
                bool all = true;
                for (std::uint32_t square = 0; square < 25; ++square) {
                    all = all &&
                          is_dithered(100 + start % edge + square % 5 * edge,
                                      200 + start / edge + square / 5 * edge, edge, pass, sets);
                }
                if (all) found = start;
            }
            REQUIRE(found < edge * edge);
            starts.insert(found);
        }
        CHECK(starts.size() >= edge * edge - 1);  // 64 passes leave out two of 16 with chance 0.03
    }
}

TEST_CASE("pixels share a set no more often than by chance, at any distance") {
    constexpr std::uint32_t kPasses = 48, kEdge = 48, kMostLag = 64;
    for (const std::uint32_t sets : {16u, 64u, 256u, 1024u}) {
        const double by_chance = 1.0 / sets;
        // The sixteen pairs of two squares share all at once or not at all, and those that meet
        // four squares less than that.
        const double sigma = std::sqrt(by_chance / (kPasses * kEdge * kEdge / 16.0));
        constexpr std::uint32_t kWide = kEdge + kMostLag;
        std::vector<std::uint32_t> set_at;  // by pass, within a pixel
        for (std::uint32_t pixel = 0; pixel < kWide * kWide; ++pixel) {
            for (std::uint64_t pass = 0; pass < kPasses; ++pass) {
                set_at.push_back(set_of_pixel(pixel % kWide, pixel / kWide, pass, sets));
            }
        }
        std::uint32_t most_often = 0;
        for (std::uint32_t lag = 1; lag <= kMostLag; ++lag) {
            for (const std::uint32_t way : {lag, lag * kWide}) {
                std::uint32_t shared = 0;
                for (std::uint32_t i = 0; i < kEdge * kEdge; ++i) {
                    const std::uint32_t pixel = i / kEdge * kWide + i % kEdge;
                    const std::uint32_t* const a = &set_at[std::size_t{pixel} * kPasses];
                    const std::uint32_t* const b = &set_at[std::size_t{pixel + way} * kPasses];
                    std::uint32_t of_pair = 0;
                    for (std::uint32_t pass = 0; pass < kPasses; ++pass) {
                        of_pair += a[pass] == b[pass] ? 1 : 0;
                    }
                    shared += of_pair;
                    most_often = std::max(most_often, of_pair);
                }
                const double often = shared / static_cast<double>(kPasses * kEdge * kEdge);
                CAPTURE(lag);
                CHECK(often < by_chance + 5.0 * sigma);
                if (lag >= 4) CHECK(often > by_chance - 5.0 * sigma);
            }
        }
        // Of 300,000 pairs, the one that shares most often by chance (of 48 passes 15 at p = 1/16).
        CHECK(most_often < 20);
    }
}

TEST_CASE("packets go round sixteen evenly spread rotations") {
    for (const std::uint32_t sets : {1u, 4u, 16u, 64u, 256u, 1024u, 4096u}) {
        const std::uint32_t used = std::min(sets, 16u);
        const SetPattern pattern(sets);
        std::set<std::uint32_t> ranks;
        for (std::uint32_t packet = 0; packet < 64; ++packet) {
            ranks.insert(pattern.rank_of(set_of_packet(packet, sets)));
        }
        CHECK(ranks.size() == used);
        for (const std::uint32_t rank : ranks) CHECK(rank % (pattern.rotations() / used) == 0);
    }
}

TEST_CASE(
    "the samples of a pixel take every set once, and all rotations of a draw before the next") {
    for (const std::uint32_t sets : {1u, 4u, 16u, 64u, 256u, 1024u, 4096u}) {
        const SetPattern pattern(sets);
        const std::uint32_t rotations = pattern.rotations();
        for (const std::uint32_t bounce : {0u, 1u, 5u}) {
            std::set<std::uint32_t> taken;
            for (std::uint32_t sample = 0; sample < sets; ++sample) {
                const std::uint32_t set = set_of_sample(37, 91, sample, bounce, sets);
                REQUIRE(set < sets);
                taken.insert(set);
                const std::uint32_t start = sample - sample % rotations;
                CHECK(pattern.draw_of(set) ==
                      pattern.draw_of(set_of_sample(37, 91, start, bounce, sets)));
            }
            CHECK(taken.size() == sets);
            CHECK(set_of_sample(37, 91, sets, bounce, sets) ==
                  set_of_sample(37, 91, 0, bounce, sets));
        }
    }
}

TEST_CASE("the first 4^n samples of a pixel are rotations evenly spread") {
    for (const std::uint32_t sets : {16u, 256u, 4096u}) {
        const SetPattern pattern(sets);
        for (std::uint32_t samples = 4; samples <= pattern.rotations(); samples *= 4) {
            std::set<std::uint32_t> strata;
            const std::uint32_t width = pattern.rotations() / samples;
            const std::uint32_t first = pattern.rank_of(set_of_sample(5, 8, 0, 2, sets));
            for (std::uint32_t sample = 0; sample < samples; ++sample) {
                const std::uint32_t rank = pattern.rank_of(set_of_sample(5, 8, sample, 2, sets));
                const std::uint32_t turn = (rank - first) & (pattern.rotations() - 1);
                CHECK(turn % width == 0);
                strata.insert(turn / width);
            }
            CHECK(strata.size() == samples);
        }
    }
}

TEST_CASE("neighbours take other sets at the same sample, and other squares other draws") {
    for (const std::uint32_t sets : {16u, 64u, 256u, 4096u}) {
        const SetPattern pattern(sets);
        for (std::uint32_t sample = 0; sample < 64; ++sample) {
            // A square of 4x4 pixels has sixteen evenly spread rotations of one draw.
            std::set<std::uint32_t> strata, draws;
            const std::uint32_t width = pattern.rotations() / 16;
            REQUIRE(width > 0);
            for (std::uint32_t y = 8; y < 12; ++y) {
                for (std::uint32_t x = 4; x < 8; ++x) {
                    const std::uint32_t set = set_of_sample(x, y, sample, 0, sets);
                    strata.insert(pattern.rank_of(set) / width);
                    draws.insert(pattern.draw_of(set));
                }
            }
            CHECK(strata.size() == 16);
            CHECK(draws.size() == 1);
        }
        std::set<std::uint32_t> draws;
        int alike = 0;
        for (std::uint32_t x = 0; x < 800; x += 4) {
            draws.insert(pattern.draw_of(set_of_sample(x, 0, 0, 0, sets)));
            alike += set_of_sample(x, 0, 0, 0, sets) == set_of_sample(x + 4, 0, 0, 0, sets) ? 1 : 0;
        }
        CHECK(draws.size() == pattern.draws());  // 200 squares miss one of 16 with chance 4e-5
        CHECK(alike < 40);                       // 12.5 expected of 16 sets: false alarm 1e-9
    }
}

TEST_CASE("draws of one pass are independent of one another") {
    // Correlation of xi of the same lights in two draws, and of lights that turn together: the
    // former is 0 but for chance, the latter 1 but for what wraps around.
    constexpr std::uint32_t kSets = 1024, kLights = 20000;
    RandomRanges ranges(1.0f, kSets);
    ranges.begin_pass(3);
    const SetPattern pattern(kSets);
    const auto correlation = [&](std::uint32_t a, std::uint32_t b) {
        double sum = 0.0;
        for (std::uint32_t light = 0; light < kLights; ++light) {
            sum += (static_cast<double>(ranges.xi(light, a)) - 0.5) *
                   (static_cast<double>(ranges.xi(light, b)) - 0.5);
        }
        return sum * 12.0 / kLights;
    };
    for (std::uint32_t draw = 1; draw < pattern.draws(); ++draw) {
        // The product has a standard deviation of 1 / sqrt(kLights): false alarm 6e-7 each.
        CHECK(std::abs(correlation(pattern.set_of(0, 0), pattern.set_of(0, draw))) <
              5.0 / std::sqrt(static_cast<double>(kLights)));
    }
    CHECK(correlation(pattern.set_of(0, 0), pattern.set_of(1, 0)) > 0.9);
}

TEST_CASE("xi is uniform, above 0, and rotated from set to set") {
    constexpr std::uint32_t kSets = 16, kLights = 100000;
    const SetPattern pattern(kSets);
    RandomRanges ranges(1.0f, kSets);
    ranges.begin_pass(5);
    std::vector<int> bins(64);
    for (std::uint32_t light = 0; light < kLights; ++light) {
        const float first = ranges.xi(light, pattern.set_of(0, 0));
        ++bins[std::min(static_cast<std::size_t>(first * 64.0f), std::size_t{63})];
        for (std::uint32_t rank = 0; rank < kSets; ++rank) {
            const float xi = ranges.xi(light, pattern.set_of(rank, 0));
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
