#include "lights/learning/cut_builder.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "base/float3_math.h"
#include "base/random.h"
#include "lights/bvh/light_bvh_kernels.h"
#include "lights/learning/cut_kernels.h"
#include "unit/test_lights.h"

namespace lightcull {
namespace {

/// Small triangles that face all ways.
LightTable facing_all_ways() {
    std::vector<Light> lights;
    RandomStream random(5);
    const auto at = [&](float size) {
        const float x = random.next(), y = random.next(), z = random.next();
        return float3{x - 0.5f, y - 0.5f, z - 0.5f} * size;
    };
    for (int i = 0; i < 1500; ++i) {
        const float3 a = at(2.0f);
        lights.push_back(triangle_light(a, a + at(0.02f), a + at(0.02f), 1.0f));
    }
    return make_light_table(lights);
}

/// So many lights that no cluster of a cut is a single one.
LightTable many_points() {
    std::vector<Light> lights;
    RandomStream random(9);
    for (int i = 0; i < 20000; ++i) {
        const float x = random.next(), y = random.next(), z = random.next();
        lights.push_back(point_light(float3{x - 0.5f, y - 0.5f, z - 0.5f} * 2.0f, 1.0f));
    }
    return make_light_table(lights);
}

/// The sum over the lights of each cluster of what a receiver is given.
std::vector<double> given_by_lights(const LightBvh<MeansNode>& bvh, const LeafOrder& leaves,
                                    const ClusterCut& cut, const Receiver& receiver) {
    constexpr std::uint32_t kWidth = LightBvhNode::kWidth;
    std::vector<double> given(cut.size);
    for (std::uint32_t n = 0; n < bvh.nodes.size(); ++n) {
        LightBvhImportances g;
        light_bvh_kernels<MeansNode>().importances(bvh.nodes[n], receiver, g.of);
        for (std::uint32_t i = 0; i < kWidth; ++i) {
            const std::uint32_t child = bvh.nodes[n].child[i];
            if (child == LightBvhNode::kEmpty || (child & LightBvhNode::kLight) == 0) continue;
            given[cut.cluster_of_leaf(leaves.first(n * kWidth + i))] += double{g.of[i]};
        }
    }
    return given;
}

/// How far weights of clusters are off, relative to all that is given.
double misjudged(const ClusterCut& cut, const Receiver& receiver,
                 const std::vector<double>& given) {
    double off = 0.0, sum = 0.0;
    for (std::uint32_t i = 0; i < cut.size; ++i) {
        const double weight = double{cut_kernels().weight_of(cut, cut.place_of[i], receiver)};
        off += std::abs(weight - given[i]);
        sum += given[i];
    }
    return off / sum;
}

/// Makes the sums of weights.
void add_up(const ClusterCut& cut, CutWeights& weights) {
    constexpr std::uint32_t kStride = CutWeights::kStride, kRuns = CutWeights::kRuns;
    float of_runs[kRuns] = {};
    for (std::uint32_t i = 0; i < weights.size; ++i) {
        of_runs[(i < weights.near_size ? 0 : kStride) + i % kStride] += weights.of[i];
    }
    for (std::uint32_t i = 0; i < kRuns; ++i) weights.sums[i] = of_runs[cut.run[i]];
    for (std::size_t from = 0, half = kRuns / 2; half > 0; half /= 2) {
        const std::size_t to = from + 2 * half;
        for (std::size_t i = 0; i < half; ++i) {
            weights.sums[to + i] = weights.sums[from + i] + weights.sums[from + half + i];
        }
        from = to;
    }
}

}  // namespace

TEST_CASE("a cut weighs clusters by what their parts give the place") {
    const LightBvh<MeansNode> bvh = build_light_bvh<MeansNode>(facing_all_ways());
    const LeafOrder leaves(bvh);
    RandomStream random(6);
    double scaled = 0.0, as_wholes = 0.0;
    for (int k = 0; k < 20; ++k) {
        const float x = 6.0f * random.next() - 3.0f, z = 6.0f * random.next() - 3.0f;
        const CutPlace place{{x, -1.5f, z}, {0, 1, 0}, 0.05f};
        ClusterCut cut;
        CutEvidence evidence;
        rebuild_cut(bvh, leaves, place, cut, evidence);
        REQUIRE(cut.size > 100);
        const Receiver receiver(place.position, place.normal);
        const std::vector<double> given = given_by_lights(bvh, leaves, cut, receiver);
        scaled += misjudged(cut, receiver, given);
        for (std::uint32_t i = 0; i < cut.size; ++i) {
            const std::uint32_t at = cut.place_of[i];
            cut.far_scale[at] *= cut.visible[i] / cut.scale[at];
            cut.scale[at] = cut.visible[i];
        }
        as_wholes += misjudged(cut, receiver, given);
    }
    CAPTURE(as_wholes);
    CHECK(scaled < 0.3 * as_wholes);
}

TEST_CASE("a cut leaves every cluster a fourth of its weight, whatever its parts say") {
    // Seen from here, none of the lights' cones reaches the place.
    std::vector<Light> lights;
    RandomStream random(7);
    for (int i = 0; i < 1000; ++i) {
        const float x = random.next(), z = random.next();
        const float away = i % 2 == 0 ? 0.5f : -0.5f;
        lights.push_back(spot_light({x, 1.0f, z}, {away, 1.0f, 0.0f}, 1.0f, 0.2f, 0.3f));
    }
    const LightBvh<MeansNode> bvh = build_light_bvh<MeansNode>(make_light_table(lights));
    ClusterCut cut;
    CutEvidence evidence;
    rebuild_cut(bvh, LeafOrder(bvh), {{0.5f, -1.0f, 0.5f}, {0, 1, 0}, 0.01f}, cut, evidence);
    REQUIRE(cut.size > 0);
    for (std::uint32_t i = 0; i < cut.size; ++i) {
        CHECK(cut.scale[cut.place_of[i]] >= 0.25f);
        CHECK(cut.scale[cut.place_of[i]] <= 4.0f);
    }
}

TEST_CASE("a cut's far clusters are weighed as the importance does it, anywhere in the cell") {
    const LightBvh<MeansNode> bvh = build_light_bvh<MeansNode>(many_points());
    const CutPlace place{{0.1f, -0.3f, 0.2f}, {0, 1, 0}, 0.05f};
    ClusterCut cut;
    CutEvidence evidence;
    rebuild_cut(bvh, LeafOrder(bvh), place, cut, evidence);
    REQUIRE(cut.near_size < cut.size);
    ClusterCut near = cut;
    near.near_size = ClusterCut::kMaxSize;
    RandomStream random(8);
    double off = 0.0, sum = 0.0;
    for (int k = 0; k < 100; ++k) {
        const float x = random.next(), y = random.next(), z = random.next();
        const float3 away = (float3{x, y, z} * 2.0f - float3{1, 1, 1}) * place.radius;
        const float3 tilted{0.5f * x, 1.0f, 0.5f * z};
        const float3 normal = tilted * (1.0f / length(tilted));
        const Receiver receiver(place.position + away, normal);
        const Receiver in_volume(place.position + away, {0, 0, 0});
        for (std::uint32_t at = 0; at < cut.size; ++at) {
            const float weight = cut_kernels().weight_of(cut, at, receiver);
            const float exact = cut_kernels().weight_of(near, at, receiver);
            if (at < cut.near_size) CHECK(weight == exact);
            // No light is lost that the importance would find.
            if (exact > 0.0f) CHECK(weight > 0.0f);
            off += std::abs(double{weight} - double{exact});
            sum += double{exact};
            const float of_volume = cut_kernels().weight_of(cut, at, in_volume);
            CHECK(of_volume == cut_kernels().weight_of(near, at, in_volume));
        }
    }
    CAPTURE(off / sum);
    CHECK(off > 0.0);
    CHECK(off < 0.04 * sum);
}

TEST_CASE("a cut's places hold each cluster once, near ones first") {
    const LightBvh<MeansNode> bvh = build_light_bvh<MeansNode>(facing_all_ways());
    ClusterCut cut;
    CutEvidence evidence;
    rebuild_cut(bvh, LeafOrder(bvh), {{0.2f, -1.5f, 0.1f}, {0, 1, 0}, 0.02f}, cut, evidence);
    CHECK(cut.near_size % ClusterCut::kBlock == 0);
    for (std::uint32_t i = 0; i < cut.size; ++i) {
        CHECK(cut.cluster_at[cut.place_of[i]] == i);
        CHECK((cut.far_scale[i] > 0.0f) == (i >= cut.near_size));
    }
    // A choice goes through them in the order of the tree's leaves, but for runs that overlap.
    CutWeights weights{};
    weights.size = weights.first_opened =
        (cut.size + ClusterCut::kBlock - 1) / ClusterCut::kBlock * ClusterCut::kBlock;
    weights.near_size = cut.near_size;
    for (std::uint32_t i = 0; i < cut.size; ++i) weights.of[i] = 1.0f;
    add_up(cut, weights);
    constexpr int kLongestRun = ClusterCut::kMaxSize / ClusterCut::kBlock;
    std::vector<std::uint8_t> chosen(cut.size);
    int last = 0, steps_back = 0;
    for (std::uint32_t i = 0; i < cut.size; ++i) {
        const CutChoice choice = choose(cut, weights, (i + 0.5) / cut.size);
        const int cluster = cut.cluster_at[choice.place];
        ++chosen[static_cast<std::size_t>(cluster)];
        steps_back += cluster < last ? 1 : 0;
        last = cluster;
    }
    CHECK(std::all_of(chosen.begin(), chosen.end(), [](int count) { return count == 1; }));
    CHECK(steps_back <= kLongestRun);
    // A cell that is as wide as all the lights has no far ones.
    rebuild_cut(bvh, LeafOrder(bvh), {{0, 0, 0}, {0, 0, 0}, 1.0f}, cut, evidence);
    CHECK(cut.near_size >= cut.size);
}

TEST_CASE("a choice out of a cut falls on each place as often as its weight says") {
    // As many places as with an odd number of opened nodes: the last row is half of one.
    ClusterCut cut;
    for (std::size_t i = 0; i < CutWeights::kRuns; ++i) {
        cut.run[i] = static_cast<std::uint8_t>(7 * i % CutWeights::kRuns);
    }
    CutWeights weights{};
    weights.near_size = 48;
    weights.first_opened = 112;
    weights.opened_count = 1;
    weights.size = weights.first_opened + CutWeights::kWidth;
    float total = 0.0f;
    for (std::uint32_t i = 0; i < weights.size; ++i) {
        weights.of[i] = static_cast<float>(i % 7 == 3 ? 0 : 1 + i % 5);
        total += weights.of[i];
    }
    add_up(cut, weights);
    REQUIRE(weights.total() == total);
    std::vector<float> chosen(weights.size);
    for (int place = 0; place < static_cast<int>(total); ++place) {
        const CutChoice choice = choose(cut, weights, (place + 0.5) / double{total});
        REQUIRE(choice.place < weights.size);
        CHECK(choice.within >= 0.0);
        CHECK(choice.within < 1.0);
        chosen[choice.place] += 1.0f;
    }
    for (std::uint32_t i = 0; i < weights.size; ++i) CHECK(chosen[i] == weights.of[i]);
}

}  // namespace lightcull
