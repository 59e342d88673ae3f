#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lights/bvh/light_bvh.h"
#include "lights/bvh/light_bvh_build.h"
#include "lights/bvh/light_bvh_slot.h"

namespace lightcull {
namespace {

constexpr std::size_t kWidth = LightBvhNode::kWidth;

/// How a binary subtree is best spread over the children of a wide node.
struct Plan {
    std::array<float, kWidth> cost{};         ///< [k]: of at most k + 1 children
    std::array<std::uint8_t, kWidth> left{};  ///< [k]: how many of them go to the left subtree;
                                              ///< 0: the subtree becomes one child
    std::uint8_t left_of_node = 0;            ///< the same for a node of its own
};

/// By dynamic programming the wide tree with the least sum, over its nodes, of the root of their
/// intensity. The sum of intensities would count the nodes visited by selections from afar, the
/// number of nodes would favour full ones; this serves both.
class Collapse {
  public:
    explicit Collapse(const std::vector<BinaryLightNode>& binary)
        : binary_(binary), plans_(binary.size()) {
        // Children come after their parents.
        for (std::size_t i = binary.size(); i-- > 0;) {
            if (!binary_[i].is_leaf()) plan(i);
        }
    }

    /// The binary nodes that become the children of the wide node of `node`, in order.
    void children(std::uint32_t node, std::vector<std::uint32_t>& result) const {
        result.clear();
        if (binary_[node].is_leaf()) {
            result.push_back(node);
        } else {
            open(node, plans_[node].left_of_node, kWidth, result);
        }
    }

  private:
    void plan(std::size_t node) noexcept {
        Plan& plan = plans_[node];
        const Plan& left = plans_[node + 1];
        const Plan& right = plans_[binary_[node].right];
        for (std::size_t k = 2; k <= kWidth; ++k) {
            plan.cost[k - 1] = std::numeric_limits<float>::max();
            for (std::size_t j = 1; j < k; ++j) {
                const float cost = left.cost[j - 1] + right.cost[k - j - 1];
                if (cost < plan.cost[k - 1]) {
                    plan.cost[k - 1] = cost;
                    plan.left[k - 1] = static_cast<std::uint8_t>(j);
                }
            }
        }
        plan.left_of_node = plan.left[kWidth - 1];
        plan.cost[0] = plan.cost[kWidth - 1] + std::sqrt(binary_[node].cluster.intensity);
        for (std::size_t k = 2; k <= kWidth; ++k) {
            if (plan.cost[k - 1] < plan.cost[0]) continue;
            plan.cost[k - 1] = plan.cost[0];
            plan.left[k - 1] = 0;
        }
    }

    void open(std::uint32_t node, std::size_t left, std::size_t count,
              std::vector<std::uint32_t>& result) const {
        place(node + 1, left, result);
        place(binary_[node].right, count - left, result);
    }
    void place(std::uint32_t node, std::size_t count, std::vector<std::uint32_t>& result) const {
        const std::size_t left = plans_[node].left[count - 1];
        if (left == 0) {
            result.push_back(node);
        } else {
            open(node, left, count, result);
        }
    }

    const std::vector<BinaryLightNode>& binary_;
    std::vector<Plan> plans_;
};

/// Nodes and links of the wide tree, breadth first; sources[slot] is the binary node to fill a slot
/// with.
template <typename Node>
void lay_out(const std::vector<BinaryLightNode>& binary, LightBvh<Node>& bvh,
             std::vector<std::uint32_t>& sources) {
    const Collapse collapse(binary);
    std::vector<std::uint32_t> roots{0}, children;  // roots: by wide node, its binary node
    bvh.parents.push_back(LightBvh<Node>::kNoSlot);
    for (std::uint32_t n = 0; n < roots.size(); ++n) {
        collapse.children(roots[n], children);
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

}  // namespace

template <typename Node>
LightBvh<Node> build_light_bvh(const LightTable& table) {
    LightBvh<Node> bvh;
    bvh.slots.resize(table.records.size(), LightBvh<Node>::kNoSlot);
    const std::vector<BinaryLightNode> binary = build_binary_light_tree(table);
    if (binary.empty()) return bvh;

    std::vector<std::uint32_t> sources;
    lay_out(binary, bvh, sources);
    tbb::parallel_for(std::size_t{0}, bvh.nodes.size(), [&](std::size_t n) {
        Node& node = bvh.nodes[n];
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
