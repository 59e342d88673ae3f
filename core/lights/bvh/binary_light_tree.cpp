#include "lights/bvh/binary_light_tree.h"

#include <algorithm>
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
    static constexpr std::uint32_t kMaxDepth = LightBvh<BoundsNode>::kMaxDepth;
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
    };

    explicit OrientationHeuristic(const LightTable& table) : table_(table) {}

    std::vector<Item> items() const {
        std::vector<Item> result;
        result.reserve(table_.lit.size());
        for (const std::uint32_t i : table_.lit) {
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
        return {size, std::max({size.x, size.y, size.z})};
    }
    /// A factor of the cost that counts against long thin sets.
    float weight(std::size_t dimension, const Scale& scale) const noexcept {
        return scale.longest / component(scale.size, dimension);
    }
    float cost(const Extent& extent, const Scale& scale) const noexcept {
        // Flat and straight sets have no area.
        constexpr float kLeastSize = 1e-2f;
        const float least = scale.longest * kLeastSize;
        const float3 size = max(extent.box.high - extent.box.low, {least, least, least});
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

}  // namespace

std::vector<BinaryLightNode> build_binary_light_tree(const LightTable& table) {
    const OrientationHeuristic heuristic(table);
    return BinnedTree<OrientationHeuristic>::build(heuristic, heuristic.items());
}

}  // namespace lightcull
