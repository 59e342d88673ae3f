#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/ranges/sphere_tree.h"

namespace lightcull {

/// The nodes of a sphere tree level by level, as a walk that reads the node found first next meets
/// them.
struct BreadthFirst {
    struct Entry {
        std::uint32_t node;   ///< the i-th node
        std::uint32_t place;  ///< place of node i
    };
    static_assert(sizeof(Entry) == 8 && offsetof(Entry, place) == 4);

    explicit BreadthFirst(const SphereTree& tree);

    std::vector<Entry> entries;
    std::vector<std::uint32_t> levels;  ///< place where each level begins, and where the last one
                                        ///< ends
};

}  // namespace lightcull
