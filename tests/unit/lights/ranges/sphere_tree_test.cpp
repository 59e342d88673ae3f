#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lights/baselines/culling_tree.h"
#include "lights/calibration/range_calibration.h"
#include "unit/sanitizer.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

std::vector<std::uint32_t> accepted_by_tree(const CullingTree& tree, const ShadingPoint& point) {
    std::vector<std::uint32_t> lights;
    tree.for_each_accepted(Receiver(tree.frame(), point), point.set,
                           [&](const Accepted& a) { lights.push_back(tree.to_light(a.record)); });
    std::sort(lights.begin(), lights.end());
    return lights;
}

std::vector<std::uint32_t> accepted_by_brute_force(const CullingTree& tree, const LightTable& table,
                                                   const ShadingPoint& point) {
    const Receiver receiver(tree.frame(), point);
    std::vector<std::uint32_t> lights;
    for (const std::uint32_t i : table.lit) {
        const LightRecord& light = table.records[i];
        const Approach way = approach(receiver.position, light.center);
        if (!(importance(light, way, receiver) > 0.0f)) continue;
        const std::uint32_t record = tree.to_record(i);
        const float xi = tree.ranges().xi(record, point.set);
        const bool accepted = tree.ranges().accepts(tree.tree().record(record), way, xi);
        // Only what fails is given to doctest, which takes longer than all the rest.
        if (tree.tree().accepts(record, point.set, way) != accepted) {
            FAIL_CHECK("light " << i << ": the tree's test and that of its range differ");
        }
        if (accepted) lights.push_back(i);
        // The test is the same as p >= xi, but for rounding.
        const double p = 1.0 / static_cast<double>(tree.tree().inverse_prob(record, way));
        const double ratio = p / static_cast<double>(xi);
        if (std::abs(ratio - 1.0) > 1e-4 && accepted != (ratio > 1.0)) {
            FAIL_CHECK("light " << i << ": accepted is " << accepted << ", p / xi " << ratio);
        }
    }
    return lights;
}

/// Compares the tree with a test of every light, at `point_count` points in each of `passes`
/// passes.
void compare(const std::vector<Light>& lights, float reach, std::uint32_t set_count,
             std::uint32_t point_count, std::uint64_t passes) {
    const LightTable table = make_light_table(lights);
    CullingTree tree(table, RandomRanges(reach, set_count));
    std::size_t accepted = 0;
    for (std::uint64_t pass = 0; pass < passes; ++pass) {
        tree.begin_pass(pass);
        for (const ShadingPoint& point : mixed_points(point_count, pass, set_count, 1.5f)) {
            const auto expected = accepted_by_brute_force(tree, table, point);
            accepted += expected.size();
            REQUIRE(accepted_by_tree(tree, point) == expected);
        }
    }
    CHECK(accepted > 0);
}

}  // namespace

TEST_CASE("the tree accepts what brute force accepts: a hundred thousand points and ranges") {
    compare(mixed_lights(1000, 21, 10.0f), 1e-2f, 16, 1000, repetitions(100, 10));
}

TEST_CASE("the tree accepts what brute force accepts: sizes and degenerate places") {
    for (const std::uint32_t count : {1u, 2u, 7u, 8u, 9u, 64u, 65u}) {
        compare(mixed_lights(count, count), 0.1f, 4, 500, 4);
    }
    std::vector<Light> one_place, one_line;
    for (int i = 0; i < 300; ++i) {
        one_place.push_back(point_light({1, 2, 3}, 1.0f));
        one_line.push_back(point_light({0.01f * static_cast<float>(i * i), 0, 0}, 1.0f));
    }
    for (Light& light : one_place) light.center = light.center * 0.2f;
    compare(one_place, 0.5f, 4, 500, 4);
    compare(one_line, 1e-3f, 4, 500, 4);
}

TEST_CASE("a tree of no lights accepts nothing") {
    const std::vector<Light> dark(5, point_light({0, 0, 0}, 0.0f));
    CullingTree tree(make_light_table(dark), RandomRanges(1.0f, 4));
    tree.begin_pass(0);
    CHECK(accepted_by_tree(tree, {{0, 0, 0}, {0, 0, 0}, 1}).empty());
    CHECK(tree.to_record(3) == CullingTree::kNoRecord);
}

TEST_CASE("every light is in the tree once, and nodes are full") {
    const LightTable table = make_light_table(mixed_lights(20000, 5));
    const SphereTree tree = build_sphere_tree(ranged_scene(table).lights, 1e-3f);
    std::vector<int> seen(table.lit.size());
    std::size_t filled = 0;
    for (const SphereNode& node : tree.nodes) {
        for (const std::uint32_t link : node.link) {
            if (link == SphereNode::kEmpty) continue;
            ++filled;
            if ((link & SphereNode::kLeaf) != 0) ++seen[tree.order[link & ~SphereNode::kLeaf]];
        }
    }
    CHECK(std::count(seen.begin(), seen.end(), 1) == 20000);
    // Fuller nodes could be had, but more of them would be visited.
    CHECK(static_cast<double>(filled) / static_cast<double>(tree.nodes.size()) > 5.0);
}
