#include "lights/ranges/binary_sphere_tree.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "base/float3_math.h"
#include "lights/ranges/sphere_tree.h"
#include "lights/tree/binned_tree.h"

namespace lightcull {
namespace {

/// A cost of splits: the cost of reading a set of lights grows with the chance that one of them is
/// accepted.
class RangeHeuristic {
  public:
    using Node = BinarySphereNode;
    using Cost = double;

    static constexpr std::size_t kDimensions = 4;  // x, y, z, and the logarithm of intensity
    static constexpr std::uint32_t kMaxDepth = SphereTree::kMaxDepth;
    static constexpr std::uint32_t kHalvedCount = 1;

    struct Item {
        std::uint32_t light;
        std::array<float, kDimensions> place;

        float at(std::size_t dimension) const noexcept { return place[dimension]; }
    };

    struct Extent {
        float3 low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
        double intensity = 0.0;
        std::uint32_t count = 0;

        void add(const Extent& other) noexcept {
            low = min(low, other.low);
            high = max(high, other.high);
            intensity += other.intensity;
            count += other.count;
        }
    };

    struct Scale {};

    RangeHeuristic(Span<const RangedLight> lights, float reach)
        : lights_(lights), reach_(static_cast<double>(reach)) {}

    std::vector<Item> items() const {
        std::vector<Item> result;
        result.reserve(lights_.size());
        for (std::uint32_t i = 0; i < lights_.size(); ++i) {
            const float3 center = lights_[i].center;
            result.push_back({i, {center.x, center.y, center.z, std::log2(lights_[i].intensity)}});
        }
        return result;
    }

    static constexpr std::uint32_t bin_count(std::uint32_t) noexcept { return 16; }

    Extent extent(const Item& item) const noexcept {
        const RangedLight& light = lights_[item.light];
        return {light.center, light.center, static_cast<double>(light.intensity), 1};
    }

    Scale scale(Span<const Item>) const noexcept { return {}; }
    double weight(std::size_t, Scale) const noexcept { return 1.0; }
    double cost(const Extent& extent, Scale) const noexcept {
        return visits(extent) * static_cast<double>(extent.count);
    }

    void open(Node& node, Span<const Item> items) const noexcept {
        Extent all;
        for (const Item& item : items) all.add(extent(item));
        node.visits = static_cast<float>(visits(all));
    }
    void close(Node&, const Node&, const Node&) const noexcept {}

  private:
    /// A measure of how often a set is visited. From a distance d, far off, some light of a set is
    /// accepted with a probability of about reach * intensity / d^2, so the root of that is the
    /// range of the set as a whole.
    double visits(const Extent& extent) const noexcept {
        const double radius = 0.5 * static_cast<double>(length(extent.high - extent.low));
        const double range = radius + std::sqrt(reach_ * extent.intensity);
        return range * range;
    }

    Span<const RangedLight> lights_;
    double reach_;
};

}  // namespace

std::vector<BinarySphereNode> build_binary_sphere_tree(Span<const RangedLight> lights,
                                                       float reach) {
    const RangeHeuristic heuristic(lights, reach);
    return BinnedTree<RangeHeuristic>::build(heuristic, heuristic.items());
}

}  // namespace lightcull
