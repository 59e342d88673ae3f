#include "lights/bvh/binary_light_tree.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/float3_math.h"
#include "lights/bvh/light_bvh.h"
#include "lights/tree/binned_tree.h"

namespace lightcull {
namespace {

float component(float3 v, std::size_t dimension) noexcept {
    return dimension == 0 ? v.x : dimension == 1 ? v.y : v.z;
}

/// The surface area orientation heuristic.
class OrientationHeuristic {
  public:
    using Node = BinaryLightNode;
    using Cost = float;

    static constexpr std::size_t kDimensions = 3;
    // One level is left for the root above near and far lights.
    static constexpr std::uint32_t kMaxDepth = LightBvh<BoundsNode>::kMaxDepth - 1;
    static constexpr std::uint32_t kHalvedCount = 2;

    struct Extent {
        Box box;
        EmissionCone cone;
        float intensity = 0.0f;
        std::uint32_t count = 0;

        void add(const Extent& other) noexcept {
            if (other.count == 0) return;
            cone = count == 0 ? other.cone : merge(cone, other.cone);
            box.add(other.box);
            intensity += other.intensity;
            count += other.count;
        }
    };

    struct Item {
        Extent extent;
        std::uint32_t light;

        /// The middle of the item's box, doubled.
        float at(std::size_t dimension) const noexcept {
            return component(extent.box.low, dimension) + component(extent.box.high, dimension);
        }
    };

    struct Scale {
        float3 size;    ///< size of the box around the set
        float longest;  ///< longest of the box's sides
        float unit;     ///< a power of 2 in which sides are about 1: areas of suns overflow
    };

    explicit OrientationHeuristic(const LightTable& table) : table_(table) {}

    /// The lights that are far, or all others.
    std::vector<Item> items(bool far) const {
        std::vector<Item> result;
        for (const std::uint32_t i : table_.lit) {
            if (is_far(table_.records[i]) != far) continue;
            const LightCluster cluster = cluster_of(table_.records[i]);
            result.push_back({{cluster.box, cluster.cone, cluster.intensity, 1}, i});
        }
        return result;
    }

    static std::uint32_t bin_count(std::uint32_t items) noexcept { return std::min(16u, items); }

    const Extent& extent(const Item& item) const noexcept { return item.extent; }

    Scale scale(Span<const Item> items) const noexcept {
        Box bounds;
        for (const Item& item : items) bounds.add(item.extent.box);
        const float3 size = bounds.high - bounds.low;
        const float longest = std::max({size.x, size.y, size.z});
        return {size, longest, longest > 0.0f ? std::ldexp(1.0f, -std::ilogb(longest)) : 1.0f};
    }
    /// A factor of the cost that counts against long thin sets.
    float weight(std::size_t dimension, const Scale& scale) const noexcept {
        return scale.longest / component(scale.size, dimension);
    }
    float cost(const Extent& extent, const Scale& scale) const noexcept {
        // Flat and straight sets have no area.
        constexpr float kLeastSize = 1e-2f;
        const float least = scale.longest * kLeastSize;
        const float3 size =
            max(extent.box.high - extent.box.low, {least, least, least}) * scale.unit;
        const float area = size.x * size.y + size.y * size.z + size.z * size.x;
        return extent.intensity * area * orientation_measure(extent.cone);
    }

    void open(Node& node, Span<const Item> items) const noexcept {
        if (items.size() == 1) node.cluster = cluster_of(table_.records[items[0].light]);
    }
    void close(Node& node, const Node& left, const Node& right) const noexcept {
        node.cluster = merge(left.cluster, right.cluster);
    }

  private:
    const LightTable& table_;
};

/// Appends the nodes of a tree to others. Returns the index of its root.
std::uint32_t append(const std::vector<BinaryLightNode>& tree,
                     std::vector<BinaryLightNode>& nodes) {
    const auto root = static_cast<std::uint32_t>(nodes.size());
    for (const BinaryLightNode& node : tree) {
        nodes.push_back(node);
        if (!node.is_leaf()) nodes.back().right += root;
    }
    return root;
}

/// A tree whose root has these two below it; where one is empty, the other.
std::vector<BinaryLightNode> joined(const OrientationHeuristic& heuristic,
                                    std::vector<BinaryLightNode> left,
                                    std::vector<BinaryLightNode> right) {
    if (right.empty()) return left;
    if (left.empty()) return right;
    std::vector<BinaryLightNode> nodes(1);
    nodes.reserve(1 + left.size() + right.size());
    append(left, nodes);
    nodes[0].right = append(right, nodes);
    heuristic.close(nodes[0], nodes[1], nodes[nodes[0].right]);
    return nodes;
}

}  // namespace

std::vector<BinaryLightNode> build_binary_light_tree(const LightTable& table) {
    const OrientationHeuristic heuristic(table);
    const auto build = [&](bool far) {
        return BinnedTree<OrientationHeuristic>::build(heuristic, heuristic.items(far));
    };
    // Of a cluster of suns and lamps only the suns would count.
    return joined(heuristic, build(false), build(true));
}

}  // namespace lightcull
