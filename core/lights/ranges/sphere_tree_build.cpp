#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "lights/ranges/binary_tree.h"
#include "lights/ranges/sphere_tree.h"

namespace lightcull {
namespace {

constexpr std::uint32_t kWidth = SphereNode::kWidth;

/// Chooses which binary nodes become slots of wide nodes, so that the wide nodes that a point
/// visits are as few as can be: dynamic programming over the binary tree.
class Collapse {
  public:
    explicit Collapse(const BinaryTree& tree) : tree_(tree), plans_(tree.nodes.size()) {
        for (std::size_t i = tree.nodes.size(); i-- > 0;) plans_[i] = plan(i);
    }

    /// The binary nodes that fill the wide node standing for `node`, which is no leaf.
    std::uint32_t slots_of(std::uint32_t node, std::array<std::uint32_t, kWidth>& slots) const {
        std::uint32_t count = 0;
        const std::uint32_t left = plans_[node].left_slots_inside;
        fill(node + 1, left, slots, count);
        fill(tree_.nodes[node].right, kWidth - left, slots, count);
        return count;
    }

  private:
    struct Plan {
        /// Cost of the subtree if it may take up to k + 1 slots.
        std::array<float, kWidth> cost;
        /// Of those, how many go to the left child; 0: the node takes one slot itself.
        std::array<std::uint8_t, kWidth> left_slots;
        std::uint8_t left_slots_inside;  ///< of the 8 of the wide node that stands for it
    };

    Plan plan(std::size_t i) const {
        Plan plan{};
        const BinaryTree::Node& node = tree_.nodes[i];
        if (node.right == 0) return plan;
        const Plan &left = plans_[i + 1], &right = plans_[node.right];
        for (std::uint32_t slots = kWidth; slots >= 2; --slots) {
            float best = std::numeric_limits<float>::max();
            std::uint8_t best_left = 1;
            for (std::uint32_t l = 1; l < slots; ++l) {
                const float cost = left.cost[l - 1] + right.cost[slots - l - 1];
                if (cost < best) {
                    best = cost;
                    best_left = static_cast<std::uint8_t>(l);
                }
            }
            if (slots == kWidth) {
                plan.left_slots_inside = best_left;
                plan.cost[0] = best + node.visits;
            }
            const bool one_slot_does = plan.cost[0] <= best;
            plan.cost[slots - 1] = one_slot_does ? plan.cost[0] : best;
            plan.left_slots[slots - 1] = one_slot_does ? std::uint8_t{0} : best_left;
        }
        return plan;
    }

    void fill(std::uint32_t node, std::uint32_t available, std::array<std::uint32_t, kWidth>& slots,
              std::uint32_t& count) const {
        const std::uint32_t left = plans_[node].left_slots[available - 1];
        if (tree_.nodes[node].right == 0 || left == 0) {
            slots[count++] = node;
            return;
        }
        fill(node + 1, left, slots, count);
        fill(tree_.nodes[node].right, available - left, slots, count);
    }

    const BinaryTree& tree_;
    std::vector<Plan> plans_;
};

/// Writes the wide nodes and the records of their leaves. Siblings lie side by side, then what is
/// below the first of them, and so on.
class Emitter {
  public:
    Emitter(Span<const RangedLight> lights, const BinaryTree& binary, SphereTree& tree)
        : lights_(lights), binary_(binary), collapse_(binary), tree_(tree) {}

    void emit_root() {
        tree_.nodes.push_back(empty_node());
        if (binary_.nodes.size() > 1) {
            emit(0, 0, 1);
        } else {
            tree_.nodes[0].link[0] = emit_light(0);
        }
    }

  private:
    static SphereNode empty_node() noexcept {
        SphereNode node{};
        std::fill(std::begin(node.link), std::end(node.link), SphereNode::kEmpty);
        return node;
    }

    std::uint32_t emit_light(std::uint32_t leaf) {
        const std::uint32_t light = binary_.nodes[leaf].light;
        tree_.records.push_back(lights_[light]);
        tree_.order.push_back(light);
        return SphereNode::kLeaf | static_cast<std::uint32_t>(tree_.records.size() - 1);
    }

    /// The node that stands for a binary one, and all below it.
    void emit(std::uint32_t node, std::uint32_t binary_node, std::uint32_t depth) {
        assert(depth <= SphereTree::kMaxDepth);
        std::array<std::uint32_t, kWidth> slots{};
        const std::uint32_t count = collapse_.slots_of(binary_node, slots);
        const auto is_leaf = [&](std::uint32_t slot) {
            return binary_.nodes[slots[slot]].right == 0;
        };
        for (std::uint32_t slot = 0; slot < count; ++slot) {
            const auto next = static_cast<std::uint32_t>(tree_.nodes.size());
            tree_.nodes[node].link[slot] = is_leaf(slot) ? emit_light(slots[slot]) : next;
            if (!is_leaf(slot)) tree_.nodes.push_back(empty_node());
        }
        for (std::uint32_t slot = 0; slot < count; ++slot) {
            if (!is_leaf(slot)) emit(tree_.nodes[node].link[slot], slots[slot], depth + 1);
        }
    }

    Span<const RangedLight> lights_;
    const BinaryTree& binary_;
    Collapse collapse_;
    SphereTree& tree_;
};

/// A sphere around spheres, and one of the same centre around the lights alone.
struct Around {
    float3 center{0, 0, 0};
    float radius = 0.0f, bounds = 0.0f;
};

/// The middle of the box around spheres.
float3 middle_of(const std::array<Around, kWidth>& spheres, std::uint32_t count) noexcept {
    float3 low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
    for (std::uint32_t i = 0; i < count; ++i) {
        const float3 r{spheres[i].radius, spheres[i].radius, spheres[i].radius};
        low = min(low, spheres[i].center - r);
        high = max(high, spheres[i].center + r);
    }
    return low * 0.5f + high * 0.5f;
}

/// The spheres of a node's slots, lights with a typical range.
std::uint32_t gather(const SphereTree& tree, const SphereNode& node, float reach,
                     const std::vector<Around>& around, std::array<Around, kWidth>& slots) {
    std::uint32_t count = 0;
    for (; count < kWidth && node.link[count] != SphereNode::kEmpty; ++count) {
        const std::uint32_t link = node.link[count];
        if ((link & SphereNode::kLeaf) == 0) {
            slots[count] = around[link];
            continue;
        }
        const RangedLight& light = tree.records[link & ~SphereNode::kLeaf];
        slots[count] = {light.center, light.radius + std::sqrt(reach * light.intensity),
                        light.radius};
    }
    return count;
}

/// Centres and bounds of slots, bottom up. The centre of an inner slot is the middle of the box
/// around the spheres below it at a typical range.
void place_slots(SphereTree& tree, float reach) {
    // Grows by more than the rounding of a sum and a distance.
    constexpr float kRoundUp = 1.0f + 1e-6f;
    std::vector<Around> around(tree.nodes.size());
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {
        SphereNode& node = tree.nodes[n];
        std::array<Around, kWidth> slots;
        const std::uint32_t count = gather(tree, node, reach, around, slots);
        around[n].center = tree.centers[n] = middle_of(slots, count);
        for (std::uint32_t slot = 0; slot < count; ++slot) {
            node.x[slot] = slots[slot].center.x;
            node.y[slot] = slots[slot].center.y;
            node.z[slot] = slots[slot].center.z;
            node.bounds[slot] = slots[slot].bounds;
            const float distance = length(slots[slot].center - around[n].center);
            around[n].radius = std::max(around[n].radius, slots[slot].radius + distance);
            around[n].bounds =
                std::max(around[n].bounds, (slots[slot].bounds + distance) * kRoundUp);
        }
    }
}

}  // namespace

SphereTree build_sphere_tree(Span<const RangedLight> lights, float reach) {
    SphereTree tree;
    const BinaryTree binary = build_binary_tree(lights, reach);
    if (binary.nodes.empty()) return tree;
    tree.records.reserve(lights.size());
    tree.order.reserve(lights.size());
    Emitter(lights, binary, tree).emit_root();
    tree.centers.resize(tree.nodes.size());
    place_slots(tree, reach);
    return tree;
}

}  // namespace lightcull
