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

    /// The first leaf of what a slot holds.
    std::uint32_t first(LightBvhSlot slot) const noexcept { return first_[slot]; }

    std::size_t memory_size() const noexcept;

  private:
    std::vector<std::uint32_t> first_;
};

}  // namespace lightcull
