#pragma once

#include <lightcull/span.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/light_record.h"

namespace lightcull {

/// Eight spheres of the tree, without their radii, which differ from set to set: radii lie apart,
/// [set][node][slot]. A slot is a light, another node, or empty. The same bytes serve all back
/// ends.
struct alignas(32) SphereNode {
    static constexpr std::uint32_t kWidth = 8;
    static constexpr std::uint32_t kLeaf = 0x80000000u;
    static constexpr std::uint32_t kEmpty = 0xffffffffu;

    float x[kWidth], y[kWidth], z[kWidth];  ///< centres
    std::uint32_t link[kWidth];             ///< kLeaf | record, or index of a node, or kEmpty

    float3 center(std::uint32_t slot) const noexcept { return {x[slot], y[slot], z[slot]}; }
};
static_assert(sizeof(SphereNode) == 128 && alignof(SphereNode) == 32);
static_assert(offsetof(SphereNode, y) == 32 && offsetof(SphereNode, z) == 64 &&
              offsetof(SphereNode, link) == 96);

/// Radius of an empty slot: no point is within it.
inline constexpr float kNoRadius = -1.0f;

/// The topology of a sphere tree over light records, one light to a leaf: built once, the same for
/// all sets and passes. Parents come before their children.
struct SphereTree {
    std::vector<SphereNode> nodes;
    std::vector<float> parent_distances;  ///< [node][slot]: to the centre of the slot above
    std::vector<std::uint32_t> parents;   ///< [node]: the slot above, 8 * node + slot
    std::vector<LightRecord> records;     ///< in the order of the leaves
    std::vector<std::uint32_t> lights;    ///< by record: index in the caller's array

    bool empty() const noexcept { return nodes.empty(); }
    std::size_t slot_count() const noexcept { return nodes.size() * SphereNode::kWidth; }

    /// No path from the root is longer, in nodes.
    static constexpr std::uint32_t kMaxDepth = 80;
};

/// Builds over the lit lights of a table. Splits are chosen so that lights that are accepted
/// together lie together, for ranges of reach * intensity (see RandomRanges). Runs in the caller's
/// TBB arena; the result does not depend on it.
SphereTree build_sphere_tree(const LightTable& table, float reach);

/// Radii of all slots of one set, bottom up: range_of(record) beyond the light's own sphere for a
/// leaf, and for an inner slot the smallest that holds the spheres below it.
template <typename RangeOf>
void refit_radii(const SphereTree& tree, RangeOf&& range_of, float* radii) noexcept {
    // Each step grows by more than the rounding of its sums and distances.
    constexpr float kRoundUp = 1.0f + 1e-6f;
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {
        const SphereNode& node = tree.nodes[n];
        float* own = radii + n * SphereNode::kWidth;
        const float* distances = tree.parent_distances.data() + n * SphereNode::kWidth;
        float around = 0.0f;
        for (std::uint32_t slot = 0; slot < SphereNode::kWidth; ++slot) {
            const std::uint32_t link = node.link[slot];
            if (link == SphereNode::kEmpty) {
                own[slot] = kNoRadius;
                continue;
            }
            if ((link & SphereNode::kLeaf) != 0) {
                const std::uint32_t record = link & ~SphereNode::kLeaf;
                own[slot] = (tree.records[record].radius + range_of(record)) * kRoundUp;
            }
            around = std::max(around, own[slot] + distances[slot]);
        }
        if (n > 0) radii[tree.parents[n]] = around * kRoundUp;
    }
}

}  // namespace lightcull
