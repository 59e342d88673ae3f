#pragma once

#include "lights/kernels.h"
#include "lights/sphere_tree.h"

namespace lightcull {

/// Where a traversal stands: nodes that are still to be read.
struct TreeWalk {
    static constexpr std::uint32_t kStackSize =
        SphereTree::kMaxDepth * (SphereNode::kWidth - 1) + 1;

    std::uint32_t stack[kStackSize];
    std::uint32_t stack_size = 0;
    std::uint32_t nodes_visited = 0;
};

/// The records whose spheres hold the point, as many as find_leaves() found at a time.
struct FoundLeaves {
    static constexpr std::uint32_t kCapacity = 64;

    std::uint32_t records[kCapacity];
    std::uint32_t count = 0;
};

/// Calls visit(record) for every leaf whose sphere holds the point and whose light may be above its
/// horizon. Returns the number of nodes read.
template <typename Visit>
std::uint32_t traverse(const SphereTree& tree, const float* radii, const LightBvhPoint& point,
                       Visit&& visit) noexcept {
    const auto find_leaves = kernels().find_leaves;
    TreeWalk walk;
    if (!tree.empty()) walk.stack[walk.stack_size++] = 0;
    FoundLeaves found;
    while (walk.stack_size > 0) {
        find_leaves(tree, radii, point, walk, found);
        for (std::uint32_t i = 0; i < found.count; ++i) visit(found.records[i]);
    }
    return walk.nodes_visited;
}

}  // namespace lightcull
