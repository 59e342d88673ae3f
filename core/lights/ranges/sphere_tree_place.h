#pragma once

#include <lightcull/span.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/ranges/sphere_tree.h"
#include "lights/tree/enclosing_sphere.h"

namespace lightcull {

/// Gives the slots of a sphere tree their centres and bounds, bottom up.
///
/// leaf_sphere(record): the sphere that encloses a light. radius_margin: see enclose(). Then calls
/// on_node(index of the node, Span of what its slots enclose, what encloses all of them).
template <typename LeafSphere, typename OnNode>
void place_slots(std::vector<SphereNode>& nodes, float radius_margin, const LeafSphere& leaf_sphere,
                 const OnNode& on_node) {
    std::vector<EnclosingSphere> around(nodes.size());
    for (std::size_t n = nodes.size(); n-- > 0;) {
        SphereNode& node = nodes[n];
        std::array<EnclosingSphere, SphereNode::kWidth> slots;
        std::size_t count = 0;
        for (; count < slots.size() && node.link[count] != SphereNode::kEmpty; ++count) {
            const std::uint32_t link = node.link[count];
            EnclosingSphere& slot = slots[count];
            slot = (link & SphereNode::kLeaf) == 0 ? around[link]
                                                   : leaf_sphere(link & ~SphereNode::kLeaf);
            node.x[count] = slot.center.x;
            node.y[count] = slot.center.y;
            node.z[count] = slot.center.z;
            node.bounds[count] = slot.bounds;
        }
        const Span<const EnclosingSphere> filled(slots.data(), count);
        around[n] = enclose(filled, radius_margin);
        on_node(n, filled, around[n]);
    }
}

}  // namespace lightcull
