#pragma once

#include <cstdint>

namespace lightcull {

/// A node of a binary tree over lights, or groups of them, one to a leaf. Nodes lie in depth-first
/// order: the left child of inner node i is i + 1. There are 2 n - 1 of them over n lights.
struct BinaryNode {
    std::uint32_t right = kLeaf;  ///< index of the right child, or kLeaf
    std::uint32_t light = 0;      ///< the caller's index of the light of a leaf

    static constexpr std::uint32_t kLeaf = 0;

    bool is_leaf() const noexcept { return right == kLeaf; }
};

}  // namespace lightcull
