#pragma once

#include <lightcull/span.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "lights/tree/binary_node.h"

namespace lightcull {

/// Builds a binary tree over items from the top down. A set is split in two at the border between
/// two of up to kMaxBins equal bins, along any dimension, where the costs of both parts have the
/// least sum (Wald 2007, "On fast construction of SAH-based bounding volume hierarchies"). The
/// first of equal costs counts. Where nothing tells the items apart the set is halved by number.
///
/// A Heuristic says what is built and what it costs:
///     struct Item;    // what is sorted: `light`, and at(dimension), its place, a float
///     struct Node;    // a BinaryNode and what two functions below write to it
///     struct Extent;  // what the cost of a set depends on: `count` items, 0 at first; add(Extent)
///     struct Scale;   // what costs within one set are relative to
///     using Cost;     // a floating-point type
///     static constexpr std::size_t kDimensions;
///     static constexpr std::uint32_t kMaxDepth;     // no path from the root is longer, in nodes;
///                                                   // above 31
///     static constexpr std::uint32_t kHalvedCount;  // up to so many items are halved by number
///     static std::uint32_t bin_count(std::uint32_t items);  // for a set of so many, <= kMaxBins
///     Extent extent(const Item&) const;
///     Scale scale(Span<const Item>) const;
///     Cost cost(const Extent&, const Scale&) const;
///     Cost weight(std::size_t dimension, const Scale&) const;  // of costs along a dimension
///     void open(Node&, Span<const Item>) const;  // called before the items of a node are split
///     void close(Node&, const Node& left, const Node& right) const;  // and after all below it
template <typename Heuristic>
class BinnedTree {
  public:
    using Item = typename Heuristic::Item;
    using Node = typename Heuristic::Node;

    static constexpr std::uint32_t kMaxBins = 16;

    /// Builds the nodes, none over no items, of which there may be 2^31. Runs in the caller's TBB
    /// arena; the result does not depend on it.
    static std::vector<Node> build(const Heuristic& heuristic, std::vector<Item> items) {
        if (items.empty()) return {};
        const auto count = static_cast<std::uint32_t>(items.size());
        std::vector<Node> nodes(2 * std::size_t{count} - 1);
        tbb::this_task_arena::isolate(
            [&] { BinnedTree(heuristic, items, nodes).build_below(0, 0, count, 0); });
        return nodes;
    }

  private:
    using Cost = typename Heuristic::Cost;
    using Extent = typename Heuristic::Extent;
    using Scale = typename Heuristic::Scale;

    static constexpr std::uint32_t kParallelSize = 2048;
    // 2^31 items that are halved fill 32 more levels.
    static constexpr std::uint32_t kHalvedDepth = Heuristic::kMaxDepth - 32;
    static_assert(Heuristic::kMaxDepth >= 32);

    /// A ruler that tells where items fall along one dimension.
    struct Ruler {
        std::size_t dimension = 0;
        std::uint32_t bins = 0;
        float low = 0.0f, inv_width = 0.0f;

        std::uint32_t bin(const Item& item) const noexcept {
            // The bin is 0 also for what is no number: an extent may be too large for a float.
            const float place = (item.at(dimension) - low) * inv_width;
            return place > 0.0f
                       ? static_cast<std::uint32_t>(std::min(place, static_cast<float>(bins - 1)))
                       : 0;
        }
    };

    struct Split {
        Ruler ruler;
        std::uint32_t last = 0;  ///< last bin of the first part
        Cost cost = std::numeric_limits<Cost>::max();

        bool found() const noexcept { return ruler.bins > 0; }
    };

    BinnedTree(const Heuristic& heuristic, std::vector<Item>& items, std::vector<Node>& nodes)
        : heuristic_(heuristic), items_(items), nodes_(nodes) {}

    /// Turns items_[begin, end) into the subtree at `node`.
    void build_below(std::uint32_t node, std::uint32_t begin, std::uint32_t end,
                     std::uint32_t depth) {
        const std::uint32_t count = end - begin;
        heuristic_.open(nodes_[node], items(begin, end));
        if (count == 1) {
            nodes_[node].light = items_[begin].light;
            return;
        }
        const std::uint32_t middle = split(begin, end, depth);
        const std::uint32_t left = node + 1, right = node + 2 * (middle - begin);
        nodes_[node].right = right;
        const auto build_left = [&] { build_below(left, begin, middle, depth + 1); };
        const auto build_right = [&] { build_below(right, middle, end, depth + 1); };
        if (count >= kParallelSize) {
            tbb::parallel_invoke(build_left, build_right);
        } else {
            build_left();
            build_right();
        }
        heuristic_.close(nodes_[node], nodes_[left], nodes_[right]);
    }

    Span<const Item> items(std::uint32_t begin, std::uint32_t end) const noexcept {
        return {items_.data() + begin, end - begin};
    }

    /// Partitions items_[begin, end) into two parts, neither empty, and returns where they meet.
    std::uint32_t split(std::uint32_t begin, std::uint32_t end, std::uint32_t depth) {
        const std::uint32_t count = end - begin;
        const bool by_cost = count > Heuristic::kHalvedCount && depth < kHalvedDepth;
        const Split best = by_cost ? find_split(items(begin, end)) : Split{};
        if (!best.found()) return begin + count / 2;
        const auto first = items_.begin() + begin;
        const auto middle = std::partition(first, items_.begin() + end, [&](const Item& item) {
            return best.ruler.bin(item) <= best.last;
        });
        return begin + static_cast<std::uint32_t>(middle - first);
    }

    Split find_split(Span<const Item> items) const noexcept {
        std::array<float, Heuristic::kDimensions> low, high;
        low.fill(std::numeric_limits<float>::max());
        high.fill(std::numeric_limits<float>::lowest());
        for (const Item& item : items) {
            for (std::size_t d = 0; d < Heuristic::kDimensions; ++d) {
                low[d] = std::min(low[d], item.at(d));
                high[d] = std::max(high[d], item.at(d));
            }
        }
        const Scale scale = heuristic_.scale(items);
        const std::uint32_t bins = Heuristic::bin_count(static_cast<std::uint32_t>(items.size()));
        Split best;
        for (std::size_t d = 0; d < Heuristic::kDimensions; ++d) {
            const float width = high[d] - low[d];
            const Ruler ruler{d, bins, low[d], static_cast<float>(bins) / width};
            if (width > 0.0f && std::isfinite(ruler.inv_width)) consider(items, ruler, scale, best);
        }
        return best;
    }

    /// Takes the best split along a ruler if it is better than `best`.
    void consider(Span<const Item> items, const Ruler& ruler, const Scale& scale,
                  Split& best) const noexcept {
        std::array<Extent, kMaxBins> bins;
        for (const Item& item : items) bins[ruler.bin(item)].add(heuristic_.extent(item));

        std::array<Cost, kMaxBins> cost_above{};  // cost of what lies in higher bins
        Extent above;
        Cost cost_so_far = 0;
        for (std::size_t b = ruler.bins; b-- > 1;) {
            if (bins[b].count > 0) {
                above.add(bins[b]);
                cost_so_far = heuristic_.cost(above, scale);
            }
            cost_above[b - 1] = cost_so_far;
        }
        const Cost weight = heuristic_.weight(ruler.dimension, scale);
        Extent below;
        for (std::uint32_t b = 0; b + 1 < ruler.bins; ++b) {
            if (bins[b].count == 0) continue;
            below.add(bins[b]);
            if (below.count == items.size()) return;
            const Cost cost = weight * (heuristic_.cost(below, scale) + cost_above[b]);
            if (cost < best.cost) best = {ruler, b, cost};
        }
    }

    const Heuristic& heuristic_;
    std::vector<Item>& items_;
    std::vector<Node>& nodes_;
};

}  // namespace lightcull
