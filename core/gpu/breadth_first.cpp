#include "gpu/breadth_first.h"

namespace lightcull {

BreadthFirst::BreadthFirst(const SphereTree& tree) : entries(tree.nodes.size()) {
    std::vector<std::uint32_t> order;
    order.reserve(tree.nodes.size());
    if (!tree.empty()) order.push_back(0);
    for (std::uint32_t i = 0; i < order.size();) {
        levels.push_back(i);
        for (const auto end = static_cast<std::uint32_t>(order.size()); i < end; ++i) {
            entries[i].node = order[i];
            entries[order[i]].place = i;
            for (const std::uint32_t link : tree.nodes[order[i]].link) {
                if ((link & SphereNode::kLeaf) == 0) order.push_back(link);
            }
        }
    }
    levels.push_back(static_cast<std::uint32_t>(order.size()));
}

}  // namespace lightcull
