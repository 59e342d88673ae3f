#include "virtual_lights/volumes/box_tree.h"

#include "base/parallel_blocks.h"

#include <algorithm>
#include <limits>

namespace lightcull {

BoxTree::BoxTree(Span<const AlignedBox> boxes) {
    constexpr std::size_t kBlock = 256;
    std::size_t size = boxes.size();
    while (size > 0) {
        std::vector<Node> nodes((size + kWidth - 1) / kWidth);
        for_each_block(nodes.size(), kBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin * kWidth; i < std::min(end * kWidth, size); ++i) {
                nodes[i / kWidth].set(i % kWidth,
                                      levels_.empty() ? boxes[i] : levels_.back()[i].bounds());
            }
        });
        size = nodes.size() > 1 ? nodes.size() : 0;
        levels_.push_back(std::move(nodes));
    }
}

/// Makes a node without children.
BoxTree::Node::Node() noexcept {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis].fill(std::numeric_limits<float>::infinity());
        high[axis].fill(-std::numeric_limits<float>::infinity());
    }
}

void BoxTree::Node::set(std::size_t child, const AlignedBox& box) noexcept {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis][child] = box.low[static_cast<int>(axis)];
        high[axis][child] = box.high[static_cast<int>(axis)];
    }
}

AlignedBox BoxTree::Node::bounds() const noexcept {
    AlignedBox box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int i = static_cast<int>(axis);
        box.low[i] = *std::min_element(low[axis].begin(), low[axis].end());
        box.high[i] = *std::max_element(high[axis].begin(), high[axis].end());
    }
    return box;
}

std::uint32_t BoxTree::Node::overlaps(const AlignedBox& box) const noexcept {
    std::array<int, kWidth> inside;
    inside.fill(1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float from = box.low[static_cast<int>(axis)];
        const float to = box.high[static_cast<int>(axis)];
        for (std::size_t i = 0; i < kWidth; ++i) {
            inside[i] &=
                static_cast<int>(low[axis][i] <= to) & static_cast<int>(high[axis][i] >= from);
        }
    }
    std::uint32_t children = 0;
    for (std::size_t i = 0; i < kWidth; ++i) {
        children |= static_cast<std::uint32_t>(inside[i]) << i;
    }
    return children;
}

}  // namespace lightcull
