#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/light_record.h"

namespace lightcull {

/// Eight clusters of lights, in the units of a LightTable, by what their importance needs
/// (light_bvh_traverse.cpp says how): one array per quantity, so that it is computed for all of
/// them at once. A cluster is a node or one light.
struct alignas(64) LightBvhNode {
    static constexpr int kWidth = 8;
    static constexpr std::uint32_t kLight = 0x80000000u;
    static constexpr std::uint32_t kEmpty = 0xffffffffu;

    float center[3][kWidth];       ///< mean position, weighted by intensity
    float radius[kWidth];          ///< of a sphere around center that holds all of the cluster
    float spread[kWidth];          ///< variance of position as the importance takes it, not 0;
                                   ///< negative: a flat light, emission does not depend on it
    float intensity[kWidth];       ///< sum; 0: empty
    float axis[3][kWidth];         ///< of the cone into which the cluster emits
    float apex[kWidth];            ///< how far behind center the cone begins that holds those of
                                   ///< all points of the sphere
    float cosine[kWidth];          ///< of the cone's half-angle, times its own absolute value; -2:
                                   ///< the cluster emits everywhere
    float mean_normal[3][kWidth];  ///< weighted by intensity; short where normals differ
    float diffuse[kWidth];         ///< what the cluster emits whatever the direction: the square of
                                   ///< twice that share of its intensity. The sign bit is set
                                   ///< where all of it is two-sided
    std::uint32_t child[kWidth];   ///< index of a node, or kLight | index of the caller, or kEmpty
};
static_assert(sizeof(LightBvhNode) == 512 && alignof(LightBvhNode) == 64);
static_assert(offsetof(LightBvhNode, radius) == 96 && offsetof(LightBvhNode, axis) == 192);
static_assert(offsetof(LightBvhNode, mean_normal) == 352 && offsetof(LightBvhNode, child) == 480);

/// One of a node's eight children, as a number: 8 * node + place.
using LightBvhSlot = std::uint32_t;

struct LightBvh {
    /// No path from the root to a light is longer.
    static constexpr int kMaxDepth = 72;
    static constexpr LightBvhSlot kNoSlot = 0xffffffffu;

    std::vector<LightBvhNode> nodes;    ///< node 0 is the root; none where no light is lit
    std::vector<LightBvhSlot> parents;  ///< by node: the slot that holds it
    std::vector<LightBvhSlot> slots;    ///< by the caller's light: its slot, kNoSlot if not lit
};

/// Builds over the lit lights of a table. Runs in the caller's TBB arena; the result does not
/// depend on it.
LightBvh build_light_bvh(const LightTable& table);

}  // namespace lightcull
