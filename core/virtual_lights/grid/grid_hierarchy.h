#pragma once

#include "virtual_lights/grid/grid_level.h"

#include <lightcull/virtual_lights/virtual_light_renderer.h>

#include <cstdint>
#include <vector>

namespace lightcull {

/// The lighting grid hierarchy of [LY19]: virtual lights at level 0, above them grids of twice the
/// cell's edge from level to level, up to one cell. Light from a distance d is taken from all
/// levels with weights blend(level, d) that sum to 1.
class GridHierarchy {
  public:
    /// lights: at least one. alpha: r_l / h_l, the accuracy.
    GridHierarchy(const std::vector<VirtualLight>& lights, float alpha, GridBuild build);

    /// The number of levels above 0: 1 at least.
    std::uint32_t level_count() const noexcept { return static_cast<std::uint32_t>(grids_.size()); }
    /// The lights of a level, 1 <= level <= level_count().
    const std::vector<GridLight>& level(std::uint32_t level) const noexcept {
        return grids_[level - 1];
    }
    /// The radius r_l = alpha h_l of a level, 0 included, metres.
    float radius(std::uint32_t level) const noexcept { return radii_[level]; }

    /// The part of the light from a distance that a level gives: a hat with its peak at r_l, 0
    /// outside [r_l / 2, 2 r_l]; level 0 gives all from below r_0, the last one all from beyond.
    float blend(std::uint32_t level, float distance) const noexcept;

  private:
    std::vector<std::vector<GridLight>> grids_;
    std::vector<float> radii_;
};

}  // namespace lightcull
