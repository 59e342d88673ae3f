#include "lights/ranges/binary_tree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lightcull {
namespace {

constexpr int kBins = 16;
constexpr int kDimensions = 4;  // x, y, z, and the logarithm of intensity
constexpr std::uint32_t kParallelSize = 4096;
// Below it lights are halved, so that no tree is deeper than this and 30 levels more.
constexpr int kMaxHeuristicDepth = 48;

/// What a set of lights costs to be read: it grows with the chance that one of them is accepted.
struct Extent {
    float3 low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
    double intensity = 0.0;
    std::uint32_t count = 0;

    void add(const RangedLight& light) noexcept {
        low = min(low, light.center);
        high = max(high, light.center);
        intensity += static_cast<double>(light.intensity);
        ++count;
    }
    void add(const Extent& other) noexcept {
        low = min(low, other.low);
        high = max(high, other.high);
        intensity += other.intensity;
        count += other.count;
    }
    /// From a distance d, far off, some light of the set is accepted with a probability of about
    /// reach * intensity / d^2, so the root of that is the range of the set as a whole.
    double visits(double reach) const noexcept {
        if (count == 0) return 0.0;
        const double radius = 0.5 * static_cast<double>(length(high - low));
        const double range = radius + std::sqrt(reach * intensity);
        return range * range;
    }
    double cost(double reach) const noexcept { return visits(reach) * static_cast<double>(count); }
};

struct Key {
    std::uint32_t light;
    std::array<float, kDimensions> at;
};

struct Split {
    double cost = 1e300;
    std::size_t dimension = kDimensions;  ///< none
    int bin = 0;                          ///< the last of the first part
    float low = 0.0f, inv_width = 0.0f;

    int bin_of(const Key& key) const noexcept {
        // 0 also for what is no number: an extent may be too large for a float.
        const float at = (key.at[dimension] - low) * inv_width;
        return at > 0.0f ? static_cast<int>(std::min(at, static_cast<float>(kBins - 1))) : 0;
    }
};

class Builder {
  public:
    Builder(Span<const RangedLight> lights, float reach, BinaryTree& tree)
        : lights_(lights), reach_(static_cast<double>(reach)), tree_(tree) {
        keys_.reserve(lights.size());
        for (std::uint32_t i = 0; i < lights.size(); ++i) {
            const RangedLight& light = lights[i];
            keys_.push_back(
                {i, {light.center.x, light.center.y, light.center.z, std::log2(light.intensity)}});
        }
    }

    /// keys_[begin, end) become the subtree at `node`.
    void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end, int depth) {
        const std::uint32_t count = end - begin;
        tree_.nodes[node].visits = static_cast<float>(extent(begin, end).visits(reach_));
        if (count == 1) {
            tree_.nodes[node].right = 0;
            tree_.nodes[node].light = keys_[begin].light;
            return;
        }
        const std::uint32_t middle =
            depth < kMaxHeuristicDepth ? split(begin, end) : begin + count / 2;
        const std::uint32_t left = node + 1, right = node + 2 * (middle - begin);
        tree_.nodes[node].right = right;
        const auto build_left = [&] { build(left, begin, middle, depth + 1); };
        const auto build_right = [&] { build(right, middle, end, depth + 1); };
        if (count >= kParallelSize) {
            tbb::parallel_invoke(build_left, build_right);
        } else {
            build_left();
            build_right();
        }
    }

  private:
    Extent extent(std::uint32_t begin, std::uint32_t end) const noexcept {
        Extent all;
        for (std::uint32_t i = begin; i < end; ++i) all.add(lights_[keys_[i].light]);
        return all;
    }

    /// Partitions keys_[begin, end) into two parts, neither empty, and returns where they meet.
    std::uint32_t split(std::uint32_t begin, std::uint32_t end) {
        Split best;
        for (std::size_t d = 0; d < kDimensions; ++d) consider(begin, end, d, best);
        if (best.dimension == kDimensions) {
            return begin + (end - begin) / 2;  // all alike: any halves will do
        }
        const auto first = keys_.begin() + begin;
        const auto middle = std::partition(first, keys_.begin() + end, [&](const Key& key) {
            return best.bin_of(key) <= best.bin;
        });
        return begin + static_cast<std::uint32_t>(middle - first);
    }

    void consider(std::uint32_t begin, std::uint32_t end, std::size_t dimension, Split& best) {
        const auto [low, high] = std::minmax_element(
            keys_.begin() + begin, keys_.begin() + end,
            [&](const Key& a, const Key& b) { return a.at[dimension] < b.at[dimension]; });
        Split split;
        split.dimension = dimension;
        split.low = low->at[dimension];
        split.inv_width = static_cast<float>(kBins) / (high->at[dimension] - split.low);
        if (!std::isfinite(split.inv_width)) return;  // no width to split

        std::array<Extent, kBins> bins;
        for (std::uint32_t i = begin; i < end; ++i) {
            const auto bin = static_cast<std::size_t>(split.bin_of(keys_[i]));
            bins[bin].add(lights_[keys_[i].light]);
        }
        std::array<double, kBins> cost_above{};
        Extent above;
        for (std::size_t b = kBins; b-- > 1;) {
            above.add(bins[b]);
            cost_above[b - 1] = above.cost(reach_);
        }
        Extent below;
        for (std::size_t b = 0; b + 1 < kBins; ++b) {
            below.add(bins[b]);
            if (below.count == 0 || below.count == end - begin) continue;
            split.cost = below.cost(reach_) + cost_above[b];
            split.bin = static_cast<int>(b);
            if (split.cost < best.cost) best = split;
        }
    }

    Span<const RangedLight> lights_;
    double reach_;
    BinaryTree& tree_;
    std::vector<Key> keys_;
};

}  // namespace

BinaryTree build_binary_tree(Span<const RangedLight> lights, float reach) {
    BinaryTree tree;
    const auto count = static_cast<std::uint32_t>(lights.size());
    if (count == 0) return tree;
    tree.nodes.resize(2 * std::size_t{count} - 1);
    Builder(lights, reach, tree).build(0, 0, count, 0);
    return tree;
}

}  // namespace lightcull
