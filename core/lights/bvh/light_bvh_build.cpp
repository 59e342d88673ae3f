#include "lights/bvh/light_bvh_build.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/float3_math.h"

namespace lightcull {
namespace {

constexpr std::uint32_t kMaxBins = 16;
constexpr std::uint32_t kParallelSize = 2048;
/// From this depth on lights are halved by number, so that 2^30 of them are at most 72 deep.
constexpr int kHalvedDepth = 40;

/// What the split of a set depends on.
struct Bin {
    Box box;
    EmissionCone cone;
    float intensity = 0.0f;
    std::uint32_t count = 0;

    void add(const Bin& other) noexcept {
        if (other.count == 0) return;
        cone = count == 0 ? other.cone : merge(cone, other.cone);
        box.add(other.box);
        intensity += other.intensity;
        count += other.count;
    }
    /// The heuristic, for extents of at least `least`: flat and straight sets have no area.
    float cost(float least) const noexcept {
        const float3 extent = max(box.high - box.low, {least, least, least});
        const float area = extent.x * extent.y + extent.y * extent.z + extent.z * extent.x;
        return intensity * area * orientation_measure(cone);
    }
};

struct Source {
    Bin bin;
    std::uint32_t light = 0;

    float3 position() const noexcept { return bin.box.low + bin.box.high; }  // doubled
};

float component(float3 v, int dimension) noexcept {
    return dimension == 0 ? v.x : dimension == 1 ? v.y : v.z;
}

/// Where lights fall along one axis.
struct Ruler {
    int dimension = 0;
    std::uint32_t bins = 0;
    float low = 0.0f, inv_width = 0.0f;

    std::uint32_t bin(const Source& source) const noexcept {
        const float place = (component(source.position(), dimension) - low) * inv_width;
        return std::min(static_cast<std::uint32_t>(place), bins - 1);
    }
};

struct Split {
    Ruler ruler;
    std::uint32_t last = 0;  ///< bin of the first part
    float cost = 3e38f;

    bool found() const noexcept { return ruler.bins > 0; }
};

class Builder {
  public:
    Builder(const LightTable& table, std::vector<BinaryLightNode>& nodes)
        : table_(table), nodes_(nodes) {
        sources_.reserve(table.lit.size());
        for (const std::uint32_t i : table.lit) {
            const LightCluster cluster = cluster_of(table.records[i]);
            sources_.push_back({{cluster.box, cluster.cone, cluster.intensity, 1}, i});
        }
    }

    /// The lights sources_[begin, end) become the subtree at `node`.
    void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end, int depth) {
        const std::uint32_t count = end - begin;
        if (count == 1) {
            const std::uint32_t light = sources_[begin].light;
            nodes_[node] = {cluster_of(table_.records[light]), BinaryLightNode::kLeaf, light};
            return;
        }
        const std::uint32_t middle = split(begin, end, depth);
        const std::uint32_t left = node + 1, right = node + 2 * (middle - begin);
        const auto build_left = [&] { build(left, begin, middle, depth + 1); };
        const auto build_right = [&] { build(right, middle, end, depth + 1); };
        if (count >= kParallelSize) {
            tbb::parallel_invoke(build_left, build_right);
        } else {
            build_left();
            build_right();
        }
        nodes_[node] = {merge(nodes_[left].cluster, nodes_[right].cluster), right, 0};
    }

  private:
    /// Partitions sources_[begin, end) into two parts, neither empty, and returns where they meet.
    std::uint32_t split(std::uint32_t begin, std::uint32_t end, int depth) {
        const Split best =
            end - begin > 2 && depth < kHalvedDepth ? find_split(begin, end) : Split{};
        if (!best.found()) return begin + (end - begin) / 2;
        const auto first = sources_.begin() + begin;
        const auto middle = std::partition(
            first, sources_.begin() + end,
            [&](const Source& source) { return best.ruler.bin(source) <= best.last; });
        return begin + static_cast<std::uint32_t>(middle - first);
    }

    Split find_split(std::uint32_t begin, std::uint32_t end) const noexcept {
        Box bounds, positions;
        for (std::uint32_t i = begin; i < end; ++i) {
            bounds.add(sources_[i].bin.box);
            const float3 position = sources_[i].position();
            positions.add({position, position});
        }
        const float3 extent = bounds.high - bounds.low;
        const float longest = std::max({extent.x, extent.y, extent.z});
        Split best;
        for (int d = 0; d < 3; ++d) {
            const float width = component(positions.high - positions.low, d);
            const std::uint32_t bins = std::min(kMaxBins, end - begin);
            const Ruler ruler{d, bins, component(positions.low, d),
                              static_cast<float>(bins) / width};
            if (!(width > 0.0f) || !std::isfinite(ruler.inv_width)) continue;
            // Against long thin sets.
            const float regularization = longest / component(extent, d);
            consider(begin, end, ruler, regularization, longest, best);
        }
        return best;
    }

    void consider(std::uint32_t begin, std::uint32_t end, const Ruler& ruler, float regularization,
                  float longest, Split& best) const noexcept {
        constexpr float kLeastExtent = 1e-2f;
        const float least = longest * kLeastExtent;
        std::array<Bin, kMaxBins> bins;
        for (std::uint32_t i = begin; i < end; ++i) {
            bins[ruler.bin(sources_[i])].add(sources_[i].bin);
        }
        std::array<float, kMaxBins> cost_above{};
        Bin above;
        float cost_so_far = 0.0f;
        for (std::uint32_t b = ruler.bins; b-- > 1;) {
            above.add(bins[b]);
            if (bins[b].count > 0) cost_so_far = above.cost(least);
            cost_above[b - 1] = cost_so_far;
        }
        Bin below;
        for (std::uint32_t b = 0; b + 1 < ruler.bins; ++b) {
            below.add(bins[b]);
            if (bins[b].count == 0 || below.count == end - begin) continue;
            const float cost = regularization * (below.cost(least) + cost_above[b]);
            if (cost < best.cost) best = {ruler, b, cost};
        }
    }

    const LightTable& table_;
    std::vector<BinaryLightNode>& nodes_;
    std::vector<Source> sources_;
};

}  // namespace

std::vector<BinaryLightNode> build_binary_light_tree(const LightTable& table) {
    const auto count = static_cast<std::uint32_t>(table.lit.size());
    if (count == 0) return {};
    std::vector<BinaryLightNode> nodes(2 * std::size_t{count} - 1);
    Builder(table, nodes).build(0, 0, count, 0);
    return nodes;
}

}  // namespace lightcull
