#include "lights/sphere_tree_refit.h"

namespace lightcull {
namespace {

/// Subtrees are runs of nodes, since each node comes before those below it.
class Splitter {
  public:
    Splitter(const SphereTree& tree, std::uint32_t largest, RefitOrder& order)
        : tree_(tree), largest_(largest), order_(order) {}

    void split(std::uint32_t begin, std::uint32_t end) {
        if (end - begin <= largest_) {
            order_.side_by_side.push_back({begin, end});
            return;
        }
        std::uint32_t last = end;
        for (std::uint32_t slot = SphereNode::kWidth; slot-- > 0;) {
            const std::uint32_t link = tree_.nodes[begin].link[slot];
            if ((link & SphereNode::kLeaf) != 0) continue;
            split(link, last);
            last = link;
        }
        order_.afterwards.push_back({begin, begin + 1});
    }

  private:
    const SphereTree& tree_;
    std::uint32_t largest_;
    RefitOrder& order_;
};

}  // namespace

RefitOrder make_refit_order(const SphereTree& tree, std::uint32_t part_count) {
    RefitOrder order;
    const auto nodes = static_cast<std::uint32_t>(tree.nodes.size());
    if (nodes > 0) Splitter(tree, nodes / part_count + 1, order).split(0, nodes);
    return order;
}

}  // namespace lightcull
