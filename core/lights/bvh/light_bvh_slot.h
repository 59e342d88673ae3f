#pragma once

#include <cstddef>

#include "lights/bvh/light_bvh.h"
#include "lights/bvh/light_bvh_cluster.h"

namespace lightcull {

enum class SlotKind { kLight, kNode };

/// Writes the quantities that the importance needs of a cluster into a slot of a node, all but its
/// child.
void fill_slot(BoundsNode& node, std::size_t place, const LightCluster& cluster,
               SlotKind kind) noexcept;
void fill_slot(MeansNode& node, std::size_t place, const LightCluster& cluster,
               SlotKind kind) noexcept;

/// Makes a slot one that is never chosen; the node was zero before.
void clear_slot(BoundsNode& node, std::size_t place) noexcept;
void clear_slot(MeansNode& node, std::size_t place) noexcept;

}  // namespace lightcull
