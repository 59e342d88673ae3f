#pragma once

#include <cstdint>
#include <vector>

#include "lights/bvh/light_bvh_cluster.h"
#include "lights/light/light_record.h"

namespace lightcull {

/// The light BVH before it is made 8 wide. Nodes lie in depth-first order: the left child of an
/// inner node follows it.
struct BinaryLightNode {
    LightCluster cluster;
    std::uint32_t right = kLeaf;  ///< index of the right child
    std::uint32_t light = 0;      ///< of a leaf: index of the caller

    static constexpr std::uint32_t kLeaf = 0;

    bool is_leaf() const noexcept { return right == kLeaf; }
};

/// Splits by the surface area orientation heuristic of Conty Estevez & Kulla 2018.
/// 2 n - 1 nodes for n lit lights, at most 72 deep. Runs in the caller's TBB arena; the result
/// does not depend on it.
std::vector<BinaryLightNode> build_binary_light_tree(const LightTable& table);

}  // namespace lightcull
