#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/ranges/ranges.h"
#include "lights/ranges/sphere_tree.h"

namespace lightcull {

/// A sweep over the nodes of a sphere tree that computes all radii of some sets.
struct Refit {
    const SphereTree& tree;
    const RandomRanges& ranges;
    std::uint32_t first_set, set_count;  ///< sets to refit; set_count: 1, 4 or kMaxSets
    float* radii;                        ///< radii from first_set on: [set][node][slot]
    float* around;                       ///< radii of spheres around all of a node: [node][set]

    static constexpr std::uint32_t kMaxSets = 16;
};

/// The parts of a tree that can be refitted side by side, and then the nodes above them.
struct RefitOrder {
    struct Part {
        std::uint32_t begin, end;  ///< nodes
    };
    std::vector<Part> side_by_side, afterwards;
};

/// Makes an order of about `part_count` parts.
RefitOrder make_refit_order(const SphereTree& tree, std::uint32_t part_count);

}  // namespace lightcull
