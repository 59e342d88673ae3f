#include "lights/ranges/sphere_tree_refit.h"

#include <algorithm>

namespace lightcull {
namespace {

/// Splits a tree into parts. The nodes below any node lie in one run, its children first.
class Splitter {
  public:
    Splitter(const SphereTree& tree, std::uint32_t largest, RefitOrder& order)
        : tree_(tree), largest_(largest), order_(order) {}

    /// Splits the nodes below a node, if there are any; their run ends at `end`.
    void split_below(std::uint32_t node, std::uint32_t end) {
        const std::uint32_t begin = first_child(node);
        if (begin == SphereNode::kEmpty) return;
        if (end - begin <= largest_) {
            order_.side_by_side.push_back({begin, end});
            return;
        }
        std::uint32_t last = end, family_end = begin;
        for (std::uint32_t slot = SphereNode::kWidth; slot-- > 0;) {
            const std::uint32_t child = tree_.nodes[node].link[slot];
            if ((child & SphereNode::kLeaf) != 0) continue;
            family_end = std::max(family_end, child + 1);
            split_below(child, last);
            last = std::min(last, first_child(child));
        }
        order_.afterwards.push_back({begin, family_end});
    }

  private:
    /// The first child of a node; kEmpty if all are leaves.
    std::uint32_t first_child(std::uint32_t node) const noexcept {
        std::uint32_t first = SphereNode::kEmpty;
        for (const std::uint32_t link : tree_.nodes[node].link) {
            if ((link & SphereNode::kLeaf) == 0) first = std::min(first, link);
        }
        return first;
    }

    const SphereTree& tree_;
    std::uint32_t largest_;
    RefitOrder& order_;
};

}  // namespace

RefitOrder make_refit_order(const SphereTree& tree, std::uint32_t part_count) {
    RefitOrder order;
    const auto nodes = static_cast<std::uint32_t>(tree.nodes.size());
    if (nodes == 0) return order;
    Splitter(tree, nodes / part_count + 1, order).split_below(0, nodes);
    order.afterwards.push_back({0, 1});
    return order;
}

}  // namespace lightcull
