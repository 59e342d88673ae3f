#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/parallel_blocks.h"
#include "lights/bvh/binary_light_tree.h"
#include "lights/bvh/light_bvh.h"
#include "lights/bvh/light_bvh_slot.h"
#include "lights/tree/wide_tree.h"

namespace lightcull {
namespace {

constexpr std::size_t kWidth = LightBvhNode::kWidth;

/// The cost of a node: the sum of intensities would count the nodes visited by selections from
/// afar, the number of nodes would favour full ones; the sum of the roots of intensities serves
/// both. Suns count by what they give near the other lights.
float cost_of(const BinaryLightNode& node) noexcept {
    const LightCluster& cluster = node.cluster;
    return std::sqrt(cluster.intensity / far_distance2(cluster.center, cluster.variance));
}

/// Makes the nodes and links of the wide tree, breadth first; sources[slot] is the binary node to
/// fill a slot with.
template <typename Node>
void lay_out(const std::vector<BinaryLightNode>& binary, LightBvh<Node>& bvh,
             std::vector<std::uint32_t>& sources) {
    const WideTree<BinaryLightNode, kWidth> wide(binary, cost_of);
    std::vector<std::uint32_t> roots{0};  // binary node of each wide node
    bvh.parents.push_back(LightBvh<Node>::kNoSlot);
    for (std::uint32_t n = 0; n < roots.size(); ++n) {
        const auto children = wide.children(roots[n]);
        sources.resize(kWidth * (std::size_t{n} + 1), LightBvhNode::kEmpty);
        for (std::size_t place = 0; place < children.size(); ++place) {
            const auto slot = static_cast<LightBvhSlot>(kWidth * n + place);
            const BinaryLightNode& child = binary[children[place]];
            sources[slot] = children[place];
            if (child.is_leaf()) {
                bvh.slots[child.light] = slot;
            } else {
                roots.push_back(children[place]);
                bvh.parents.push_back(slot);
            }
        }
    }
    bvh.nodes.resize(roots.size());
}

/// Fills the slots of wide node n, all but the links to other nodes.
template <typename Node>
void fill_node(const std::vector<BinaryLightNode>& binary,
               const std::vector<std::uint32_t>& sources, std::size_t n, Node& node) {
    node = {};
    for (std::size_t place = 0; place < kWidth; ++place) {
        const std::uint32_t source = sources[kWidth * n + place];
        if (source == LightBvhNode::kEmpty) {
            clear_slot(node, place);
        } else if (binary[source].is_leaf()) {
            fill_slot(node, place, binary[source].cluster, SlotKind::kLight);
            node.child[place] = LightBvhNode::kLight | binary[source].light;
        } else {
            fill_slot(node, place, binary[source].cluster, SlotKind::kNode);
        }
    }
}

}  // namespace

template <typename Node>
LightBvh<Node> build_light_bvh(const LightTable& table) {
    LightBvh<Node> bvh;
    bvh.slots.resize(table.records.size(), LightBvh<Node>::kNoSlot);
    const std::vector<BinaryLightNode> binary = build_binary_light_tree(table);
    if (binary.empty()) return bvh;

    std::vector<std::uint32_t> sources;
    lay_out(binary, bvh, sources);
    constexpr std::size_t kBlock = 64;
    for_each_block(bvh.nodes.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) fill_node(binary, sources, n, bvh.nodes[n]);
    });
    for (std::size_t n = 1; n < bvh.nodes.size(); ++n) {
        const LightBvhSlot parent = bvh.parents[n];
        bvh.nodes[parent / kWidth].child[parent % kWidth] = static_cast<std::uint32_t>(n);
    }
    return bvh;
}

template LightBvh<BoundsNode> build_light_bvh(const LightTable& table);
template LightBvh<MeansNode> build_light_bvh(const LightTable& table);

}  // namespace lightcull
