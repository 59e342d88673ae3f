#pragma once

#include <vector>

#include "lights/bvh/light_bvh_cluster.h"
#include "lights/light/light_record.h"
#include "lights/tree/binary_node.h"

namespace lightcull {

/// The light BVH before it is made 8 wide.
struct BinaryLightNode : BinaryNode {
    LightCluster cluster;
};

/// Splits by the surface area orientation heuristic of Conty Estevez & Kulla 2018.
/// 2 n - 1 nodes for n lit lights, at most 72 deep. Runs in the caller's TBB arena; the result
/// does not depend on it.
std::vector<BinaryLightNode> build_binary_light_tree(const LightTable& table);

}  // namespace lightcull
