#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/bvh/light_bvh.h"

namespace lightcull {

/// The lights of a tree numbered from left to right, so that the lights of any cluster follow one
/// another. The numbers stay where the tree is refitted.
class LeafOrder {
  public:
    explicit LeafOrder(const LightBvh<MeansNode>& bvh);

    /// The number of leaves.
    std::uint32_t size() const noexcept { return size_; }
    /// The first leaf of what a slot holds.
    std::uint32_t first(LightBvhSlot slot) const noexcept { return first_[slot]; }

    /// The leaf after the last of what a slot of this tree holds.
    std::uint32_t end(const LightBvh<MeansNode>& bvh, LightBvhSlot slot) const noexcept;

    std::size_t memory_size() const noexcept;

  private:
    std::vector<std::uint32_t> first_;
    std::uint32_t size_ = 0;
};

}  // namespace lightcull
