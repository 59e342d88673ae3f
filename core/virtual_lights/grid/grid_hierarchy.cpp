#include "virtual_lights/grid/grid_hierarchy.h"

#include "base/parallel_blocks.h"

#include <ImathBox.h>
#include <algorithm>
#include <cmath>

namespace lightcull {
namespace {

/// The largest number of levels. With more, cells would have no Morton code.
constexpr std::uint32_t kMostLevels = 10;

std::vector<LightMoments> all_moments(const std::vector<VirtualLight>& lights) {
    std::vector<LightMoments> moments(lights.size());
    constexpr std::size_t kBlock = 4096;
    for_each_block(lights.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) moments[i] = moments_of(lights[i]);
    });
    // A light that has no luminance has no place.
    moments.erase(std::remove_if(moments.begin(), moments.end(),
                                 [](const LightMoments& m) { return !(m.weight > 0.0); }),
                  moments.end());
    return moments;
}

std::vector<GridLight> lights_of(const std::vector<LightMoments>& moments) {
    std::vector<GridLight> lights;
    lights.reserve(moments.size());
    for (const LightMoments& m : moments) lights.push_back(light_of(m));
    return lights;
}

}  // namespace

GridHierarchy::GridHierarchy(const std::vector<VirtualLight>& lights, float alpha,
                             GridBuild build) {
    const std::vector<LightMoments> all = all_moments(lights);
    Imath::Box3f box;
    for (const LightMoments& m : all) box.extendBy(V3f(m.position / m.weight));
    const V3f size = box.isEmpty() ? V3f(0.0f) : box.size();
    const V3f origin = box.isEmpty() ? V3f(0.0f) : box.min;
    const float top = std::max(max_component(size), 1e-6f);

    // The levels are as many as leave level 1 less than half as many lights as there are ([LY19]
    // section 4.3). Lights on surfaces fill about the square of the cells along an edge.
    const double cells = std::sqrt(static_cast<double>(lights.size()));
    auto levels = static_cast<std::uint32_t>(
        std::clamp(std::ceil(std::log2(cells)) + 1.0, 1.0, static_cast<double>(kMostLevels)));
    std::vector<LightMoments> first;
    for (;; --levels) {
        first = scatter_to_vertices(all, {origin, std::ldexp(top, 1 - static_cast<int>(levels))});
        if (levels == 1 || 2 * first.size() < all.size()) break;
    }
    grids_.push_back(lights_of(first));
    const std::vector<LightMoments>& source = build == GridBuild::kGather ? first : all;
    for (std::uint32_t level = 2; level <= levels; ++level) {
        const float edge = std::ldexp(top, static_cast<int>(level) - static_cast<int>(levels));
        grids_.push_back(lights_of(scatter_to_vertices(source, {origin, edge})));
    }
    for (std::uint32_t level = 0; level <= levels; ++level) {
        radii_.push_back(alpha *
                         std::ldexp(top, static_cast<int>(level) - static_cast<int>(levels)));
    }
}

float GridHierarchy::blend(std::uint32_t level, float distance) const noexcept {
    const float r = radii_[level];
    if (distance < r) return level == 0 ? 1.0f : std::max(0.0f, 2.0f * distance / r - 1.0f);
    return level == level_count() ? 1.0f : std::max(0.0f, 2.0f - distance / r);
}

}  // namespace lightcull
