#pragma once

#include "base/memory_size.h"
#include "render/vec.h"

#include <lightcull/span.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightcull {

/// A box with edges along the axes.
struct AlignedBox {
    V3f low{0.0f}, high{0.0f};
};

/// Finds, of many boxes, those that overlap another. 16 of them, in the order in which they are
/// given, make a node, 16 nodes the next one; boxes that are given near each other should lie near
/// each other and be of a size.
class BoxTree {
  public:
    BoxTree() = default;
    explicit BoxTree(Span<const AlignedBox> boxes);

    /// Calls visit(index) for the boxes that overlap `with`, a finite one, in their order.
    template <typename Visit>
    void for_overlapping(const AlignedBox& with, Visit&& visit) const {
        if (!levels_.empty()) descend(levels_.size() - 1, 0, with, visit);
    }

    /// The memory that the tree takes, bytes.
    std::size_t memory_size() const noexcept {
        std::size_t sum = 0;
        for (const std::vector<Node>& level : levels_) sum += size_of(level);
        return sum;
    }

  private:
    static constexpr std::size_t kWidth = 16;

    /// Boxes side by side, so that they are tested together.
    struct Node {
        std::array<std::array<float, kWidth>, 3> low, high;

        Node() noexcept;
        void set(std::size_t child, const AlignedBox& box) noexcept;
        AlignedBox bounds() const noexcept;
        /// A mask with a bit for each child that overlaps the box.
        std::uint32_t overlaps(const AlignedBox& box) const noexcept;
    };

    template <typename Visit>
    void descend(std::size_t level, std::size_t index, const AlignedBox& with, Visit& visit) const {
        std::uint32_t children = levels_[level][index].overlaps(with);
        for (std::size_t child = index * kWidth; children != 0; ++child, children >>= 1) {
            if ((children & 1u) == 0) continue;
            if (level == 0) {
                visit(static_cast<std::uint32_t>(child));
            } else {
                descend(level - 1, child, with, visit);
            }
        }
    }

    std::vector<std::vector<Node>> levels_;  // nodes over the boxes first, the root last
};

}  // namespace lightcull
