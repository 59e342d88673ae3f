#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/sphere_tree.h"

namespace lightcull {

/// Radii of all slots, bottom up, for kSets sets in one sweep: beyond the light's own sphere by its
/// range for a leaf; for an inner slot, the smallest that holds the spheres below it.
/// ranges_of(record, std::array<float, kSets>&) tells the ranges; radii are [set][node][slot].
template <std::size_t kSets, typename RangesOf>
void refit_radii(const SphereTree& tree, RangesOf&& ranges_of, float* radii) {
    using Lanes = std::array<float, kSets>;
    constexpr std::size_t kWidth = SphereNode::kWidth;
    // Each step grows by more than the rounding of its sums and distances.
    constexpr float kRoundUp = 1.0f + 1e-6f;
    std::vector<Lanes> around(tree.nodes.size());
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {
        const SphereNode& node = tree.nodes[n];
        std::array<Lanes, kWidth> slots;
        Lanes largest{};
        for (std::size_t slot = 0; slot < kWidth; ++slot) {
            Lanes& own = slots[slot];
            const std::uint32_t link = node.link[slot];
            if (link == SphereNode::kEmpty) {
                own.fill(kNoRadius);
                continue;
            }
            if ((link & SphereNode::kLeaf) != 0) {
                const std::uint32_t record = link & ~SphereNode::kLeaf;
                const float light_radius = tree.records[record].radius;
                ranges_of(record, own);
                for (float& radius : own) radius = (radius + light_radius) * kRoundUp;
            } else {
                own = around[link];
            }
            const float distance = tree.parent_distances[n * kWidth + slot];
            for (std::size_t set = 0; set < kSets; ++set) {
                largest[set] = std::max(largest[set], own[set] + distance);
            }
        }
        for (std::size_t set = 0; set < kSets; ++set) {
            around[n][set] = largest[set] * kRoundUp;
            float* out = radii + set * tree.slot_count() + n * kWidth;
            for (std::size_t slot = 0; slot < kWidth; ++slot) out[slot] = slots[slot][set];
        }
    }
}

}  // namespace lightcull
