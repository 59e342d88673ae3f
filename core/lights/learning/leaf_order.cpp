#include "lights/learning/leaf_order.h"

#include "base/memory_size.h"

namespace lightcull {

LeafOrder::LeafOrder(const LightBvh<MeansNode>& bvh) {
    constexpr std::size_t kWidth = LightBvhNode::kWidth;
    const auto is_light = [](std::uint32_t child) { return (child & LightBvhNode::kLight) != 0; };
    // Nodes come before those below them.
    std::vector<std::uint32_t> sizes(bvh.nodes.size());
    for (std::size_t n = sizes.size(); n-- > 0;) {
        for (const std::uint32_t child : bvh.nodes[n].child) {
            if (child != LightBvhNode::kEmpty) sizes[n] += is_light(child) ? 1 : sizes[child];
        }
    }
    if (!sizes.empty()) size_ = sizes[0];
    first_.resize(kWidth * bvh.nodes.size());
    std::vector<std::uint32_t> first_of_node(bvh.nodes.size());
    for (std::size_t n = 0; n < bvh.nodes.size(); ++n) {
        std::uint32_t next = first_of_node[n];
        for (std::size_t place = 0; place < kWidth; ++place) {
            const std::uint32_t child = bvh.nodes[n].child[place];
            first_[kWidth * n + place] = next;
            if (child == LightBvhNode::kEmpty) continue;
            if (!is_light(child)) first_of_node[child] = next;
            next += is_light(child) ? 1 : sizes[child];
        }
    }
}

std::uint32_t LeafOrder::end(const LightBvh<MeansNode>& bvh, LightBvhSlot slot) const noexcept {
    constexpr std::uint32_t kWidth = LightBvhNode::kWidth;
    while (true) {
        const std::uint32_t child = bvh.nodes[slot / kWidth].child[slot % kWidth];
        if ((child & LightBvhNode::kLight) != 0) return first_[slot] + 1;
        std::uint32_t last = kWidth - 1;
        while (bvh.nodes[child].child[last] == LightBvhNode::kEmpty) --last;
        slot = child * kWidth + last;
    }
}

std::size_t LeafOrder::memory_size() const noexcept {
    return size_of(first_);
}

}  // namespace lightcull
