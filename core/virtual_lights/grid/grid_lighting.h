#pragma once

#include "lights/ranges/range_tree.h"
#include "virtual_lights/grid/grid_hierarchy.h"
#include "virtual_lights/tiles/tiled_lighting.h"

#include <lightcull/span.h>

#include <optional>
#include <vector>

namespace lightcull {

/// Finds the lights of a hierarchy that give a point something: all of them stand in one sphere
/// tree with a range of 2 r_l, beyond which blend() is 0, but for the lights of the last level,
/// which have no range.
class GridFinder {
  public:
    /// Both arguments must outlive the finder.
    GridFinder(const std::vector<VirtualLight>& lights, const GridHierarchy& hierarchy);

    /// A light of level 0, if `level` is 0, or of a grid.
    struct Found {
        std::uint32_t level, index;
    };
    /// The light of a number below count().
    Found operator[](std::uint32_t number) const noexcept { return found_[number]; }
    std::uint32_t count() const noexcept { return static_cast<std::uint32_t>(found_.size()); }

    /// Calls visit(number, found) for the lights that give a point something.
    template <typename Visit>
    void for_each(const Receiver& receiver, Visit&& visit) const noexcept {
        tree_->for_accepted(receiver, 0, [&](Span<const std::uint32_t> records) {
            for (const std::uint32_t record : records) {
                const std::uint32_t number = tree_->tree().order[record];
                visit(number, found_[number]);
            }
        });
        for (std::uint32_t number = first_unlimited_; number < count(); ++number) {
            visit(number, found_[number]);
        }
    }

  private:
    std::vector<Found> found_;
    std::uint32_t first_unlimited_ = 0;  // first light of the last level
    std::optional<RangeTree> tree_;
};

/// Adds to each pixel the light of virtual lights that its surface sends to the camera, by a
/// lighting grid hierarchy: [LY19] sections 3.2 and 3.3. Runs in the caller's TBB arena.
LightingCounts add_grid_lighting(const LightingPass& pass, const std::vector<VirtualLight>& lights,
                                 const GridHierarchy& hierarchy, Span<V3f> pixels);

}  // namespace lightcull
