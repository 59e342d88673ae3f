#pragma once

#include <lightcull/span.h>

#include <cstdint>
#include <vector>

#include "lights/ranges/ranges.h"

namespace lightcull {

/// A binary tree over lights in depth-first order, from which the wide tree is made: the left child
/// of node i is i + 1.
struct BinaryTree {
    struct Node {
        std::uint32_t right;  ///< index of the right child; 0 for a leaf
        std::uint32_t light;  ///< of a leaf: its index
        float visits;         ///< grows with the chance that a point visits the node
    };
    std::vector<Node> nodes;  ///< 2 n - 1, or none
};

/// Splits lights of intensity above 0 top down by a surface area heuristic for random ranges. Runs
/// in the caller's TBB arena; the result does not depend on it.
BinaryTree build_binary_tree(Span<const RangedLight> lights, float reach);

}  // namespace lightcull
