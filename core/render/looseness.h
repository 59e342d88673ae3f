#pragma once

#include "render/vec.h"

#include <lightcull/span.h>

#include <cstdint>
#include <vector>

namespace lightcull {

/// Tells how much looser a tree over triangles has become since it was built, without looking at
/// it: by the boxes about runs of triangles that lay next to each other then. The areas of boxes
/// are what a ray meets of them (the surface area heuristic).
class Looseness {
  public:
    Looseness() = default;
    Looseness(Span<const V3f> positions, Span<const std::uint32_t> indices);

    /// The area of all boxes, over what it was when this was made: 1 is as tight.
    float growth(Span<const V3f> positions, Span<const std::uint32_t> indices) const;

    /// The memory that this takes, bytes.
    std::size_t memory_size() const noexcept;

  private:
    double area(Span<const V3f> positions, Span<const std::uint32_t> indices) const;

    std::vector<std::uint32_t> triangles_;  ///< triangles of some runs, one after the other
    double built_area_ = 0.0;
};

}  // namespace lightcull
