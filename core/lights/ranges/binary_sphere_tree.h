#pragma once

#include <lightcull/span.h>

#include <vector>

#include "lights/ranges/ranges.h"
#include "lights/tree/binary_node.h"

namespace lightcull {

/// The sphere tree before it is made 8 wide.
struct BinarySphereNode : BinaryNode {
    float visits = 0.0f;  ///< number that grows with the chance that a point visits the node
};

/// Splits lights of intensity above 0 by a surface area heuristic for random ranges: makes 2 n - 1
/// nodes, or none, at most SphereTree::kMaxDepth deep. Runs in the caller's TBB arena; the result
/// does not depend on it.
std::vector<BinarySphereNode> build_binary_sphere_tree(Span<const RangedLight> lights, float reach);

}  // namespace lightcull
