#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include "lights/ranges/binary_sphere_tree.h"
#include "lights/ranges/sphere_tree.h"
#include "lights/ranges/sphere_tree_place.h"
#include "lights/tree/wide_tree.h"

namespace lightcull {
namespace {

/// Writes the wide nodes and the records of their leaves. Siblings lie side by side, then what is
/// below the first of them, and so on.
class Emitter {
  public:
    Emitter(Span<const RangedLight> lights, const std::vector<BinarySphereNode>& binary,
            SphereTree& tree)
        : lights_(lights),
          binary_(binary),
          wide_(binary, [](const BinarySphereNode& node) { return node.visits; }),
          tree_(tree) {}

    void emit_root() {
        tree_.nodes.push_back(empty_node());
        emit(0, 0, 1);
    }

  private:
    static SphereNode empty_node() noexcept {
        SphereNode node{};
        std::fill(std::begin(node.link), std::end(node.link), SphereNode::kEmpty);
        return node;
    }

    std::uint32_t emit_light(std::uint32_t leaf) {
        const std::uint32_t light = binary_[leaf].light;
        tree_.records.push_back(lights_[light]);
        tree_.order.push_back(light);
        return SphereNode::kLeaf | static_cast<std::uint32_t>(tree_.records.size() - 1);
    }

    /// Emits the node that stands for a binary one, and all below it.
    void emit(std::uint32_t node, std::uint32_t binary_node, std::uint32_t depth) {
        assert(depth <= SphereTree::kMaxDepth);
        const auto slots = wide_.children(binary_node);
        const auto is_leaf = [&](std::uint32_t slot) { return binary_[slots[slot]].is_leaf(); };
        for (std::uint32_t slot = 0; slot < slots.size(); ++slot) {
            const auto next = static_cast<std::uint32_t>(tree_.nodes.size());
            tree_.nodes[node].link[slot] = is_leaf(slot) ? emit_light(slots[slot]) : next;
            if (!is_leaf(slot)) tree_.nodes.push_back(empty_node());
        }
        for (std::uint32_t slot = 0; slot < slots.size(); ++slot) {
            if (!is_leaf(slot)) emit(tree_.nodes[node].link[slot], slots[slot], depth + 1);
        }
    }

    Span<const RangedLight> lights_;
    const std::vector<BinarySphereNode>& binary_;
    WideTree<BinarySphereNode, SphereNode::kWidth> wide_;
    SphereTree& tree_;
};

/// Places the centres and bounds of slots. The centre of an inner slot is the middle of the box
/// around the spheres below it at a typical range.
void place_at_typical_range(SphereTree& tree, float reach) {
    tree.centers.resize(tree.nodes.size());
    const auto light_sphere = [&](std::uint32_t record) -> EnclosingSphere {
        const RangedLight& light = tree.records[record];
        return {light.center, light.radius + std::sqrt(reach * light.intensity), light.radius};
    };
    const auto keep_center = [&](std::size_t node, Span<const EnclosingSphere>,
                                 const EnclosingSphere& around) {
        tree.centers[node] = around.center;
    };
    constexpr float kNoMargin = 1.0f;  // no margin: a refit finds the radii that hold
    place_slots(tree.nodes, kNoMargin, light_sphere, keep_center);
}

}  // namespace

SphereTree build_sphere_tree(Span<const RangedLight> lights, float reach) {
    SphereTree tree;
    const std::vector<BinarySphereNode> binary = build_binary_sphere_tree(lights, reach);
    if (binary.empty()) return tree;
    tree.records.reserve(lights.size());
    tree.order.reserve(lights.size());
    Emitter(lights, binary, tree).emit_root();
    place_at_typical_range(tree, reach);
    return tree;
}

SphereTree refit_sphere_tree(const SphereTree& tree, Span<const RangedLight> records, float reach) {
    SphereTree result = tree;
    result.records.assign(records.begin(), records.end());
    place_at_typical_range(result, reach);
    return result;
}

}  // namespace lightcull
