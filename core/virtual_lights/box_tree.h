#pragma once

#include "virtual_lights/tile_bounds.h"

#include <lightcull/span.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightcull {

/// Finds, of many boxes, those that may overlap a piece of a tile. 16 of them, in the order in
/// which they are given, make a node, 16 nodes the next one; what is given near each other should
/// lie near each other and be of a size.
class BoxTree {
  public:
    BoxTree() = default;
    explicit BoxTree(Span<const ViewBox> boxes);

    /// Calls visit(index) for the boxes that overlap the box of a piece, in their order.
    template <typename Visit>
    void for_overlapping(const FrustumPiece& piece, Visit&& visit) const {
        if (!levels_.empty()) descend(levels_.size() - 1, 0, piece, visit);
    }

  private:
    static constexpr std::size_t kWidth = 16;

    /// Boxes side by side, so that they are tested together.
    struct Node {
        std::array<std::array<float, kWidth>, 3> low, high;

        Node() noexcept;
        void set(std::size_t child, const ViewBox& box) noexcept;
        ViewBox bounds() const noexcept;
        /// Bit by child.
        std::uint32_t overlaps(const FrustumPiece& piece) const noexcept;
    };

    template <typename Visit>
    void descend(std::size_t level, std::size_t index, const FrustumPiece& piece,
                 Visit& visit) const {
        std::uint32_t children = levels_[level][index].overlaps(piece);
        for (std::size_t child = index * kWidth; children != 0; ++child, children >>= 1) {
            if ((children & 1u) == 0) continue;
            if (level == 0) {
                visit(static_cast<std::uint32_t>(child));
            } else {
                descend(level - 1, child, piece, visit);
            }
        }
    }

    std::vector<std::vector<Node>> levels_;  // those of the boxes first, the root last
};

}  // namespace lightcull
