#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/random.h"
#include "lights/tree/binary_node.h"
#include "lights/tree/wide_tree.h"

using namespace lightcull;

namespace {

struct CostNode : BinaryNode {
    float cost = 0.0f;  ///< cost of a wide node that stands for it
};

float cost_of(const CostNode& node) noexcept {
    return node.cost;
}

/// A tree of random shape below `nodes.size()`, with whole-number costs: their sums are exact.
void append_random_tree(std::uint32_t leaves, RandomStream& random, std::vector<CostNode>& nodes) {
    const std::size_t node = nodes.size();
    nodes.emplace_back();
    nodes[node].cost = std::floor(100.0f * random.next());
    if (leaves == 1) return;
    const auto left =
        1 + std::min(static_cast<std::uint32_t>(random.next() * static_cast<float>(leaves - 1)),
                     leaves - 2);
    append_random_tree(left, random, nodes);
    nodes[node].right = static_cast<std::uint32_t>(nodes.size());
    append_random_tree(leaves - left, random, nodes);
}

std::vector<CostNode> random_tree(std::uint32_t leaves, std::uint64_t seed) {
    RandomStream random(seed);
    std::vector<CostNode> nodes;
    append_random_tree(leaves, random, nodes);
    return nodes;
}

float least_cost(const std::vector<CostNode>& binary, std::uint32_t node, std::size_t width);

/// The least cost of what `open` nodes, children of one wide node, become, by trying all ways to
/// replace the ones from `next` on by both of theirs.
float least_cost_of_children(const std::vector<CostNode>& binary, std::vector<std::uint32_t> open,
                             std::size_t next, std::size_t width) {
    if (next == open.size()) {
        float sum = 0.0f;
        for (const std::uint32_t node : open) sum += least_cost(binary, node, width);
        return sum;
    }
    const std::uint32_t node = open[next];
    const float kept = least_cost_of_children(binary, open, next + 1, width);
    if (binary[node].is_leaf() || open.size() == width) return kept;
    open[next] = node + 1;
    open.insert(open.begin() + static_cast<std::ptrdiff_t>(next) + 1, binary[node].right);
    return std::min(kept, least_cost_of_children(binary, open, next, width));
}

/// The least cost, by brute force.
float least_cost(const std::vector<CostNode>& binary, std::uint32_t node, std::size_t width) {
    if (binary[node].is_leaf()) return 0.0f;
    return binary[node].cost +
           least_cost_of_children(binary, {node + 1, binary[node].right}, 0, width);
}

struct Walk {
    float cost = 0.0f;
    std::vector<std::uint32_t> leaves;  ///< leaves from left to right
};

template <std::size_t kWidth>
void walk(const std::vector<CostNode>& binary, const WideTree<CostNode, kWidth>& wide,
          std::uint32_t node, Walk& result) {
    if (!binary[node].is_leaf()) result.cost += binary[node].cost;
    const auto children = wide.children(node);
    REQUIRE(children.size() >= (binary[node].is_leaf() ? 1 : 2));
    REQUIRE(children.size() <= kWidth);
    for (const std::uint32_t child : children) {
        if (binary[child].is_leaf()) {
            result.leaves.push_back(child);
        } else {
            REQUIRE(child > node);
            walk(binary, wide, child, result);
        }
    }
}

template <std::size_t kWidth>
void check_optimal(std::uint32_t leaves, std::uint64_t seed) {
    const std::vector<CostNode> binary = random_tree(leaves, seed);
    const WideTree<CostNode, kWidth> wide(binary, cost_of);
    Walk found;
    walk(binary, wide, 0, found);
    CHECK(found.cost == least_cost(binary, 0, kWidth));
    std::vector<std::uint32_t> all;
    for (std::uint32_t n = 0; n < binary.size(); ++n) {
        if (binary[n].is_leaf()) all.push_back(n);
    }
    CHECK(found.leaves == all);
}

}  // namespace

TEST_CASE("wide tree: no collapse of a small tree costs less, by brute force") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        for (std::uint32_t leaves = 1; leaves <= 12; ++leaves) {
            check_optimal<3>(leaves, seed);
            check_optimal<4>(leaves, seed);
            check_optimal<8>(leaves, seed);
        }
    }
}

TEST_CASE("wide tree: of width 2 it is the binary tree") {
    const std::vector<CostNode> binary = random_tree(200, 1);
    const WideTree<CostNode, 2> wide(binary, cost_of);
    for (std::uint32_t n = 0; n < binary.size(); ++n) {
        const auto children = wide.children(n);
        if (binary[n].is_leaf()) {
            CHECK((children.size() == 1 && children[0] == n));
        } else {
            CHECK((children.size() == 2 && children[0] == n + 1 && children[1] == binary[n].right));
        }
    }
}

TEST_CASE("wide tree: costs that overflow leave a tree of all leaves") {
    std::vector<CostNode> binary = random_tree(100, 2);
    for (CostNode& node : binary) node.cost = std::numeric_limits<float>::max();
    const WideTree<CostNode, 8> wide(binary, cost_of);
    Walk found;
    walk(binary, wide, 0, found);
    CHECK(found.leaves.size() == 100);
}
