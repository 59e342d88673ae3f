#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/bvh/light_bvh.h"
#include "lights/light/light_record.h"
#include "lights/light/receiver.h"
#include "lights/ranges/ranges.h"

namespace lightcull {

/// A group of lights that share a range, as one cluster. Its child is a subtree of
/// LightGroups::bvh, or a light.
struct alignas(64) LightGroup : ClusterMeans<1> {
    float3 position() const noexcept { return {center[0][0], center[1][0], center[2][0]}; }
    RangedLight ranged() const noexcept { return {position(), radius[0], intensity[0]}; }
};
static_assert(sizeof(LightGroup) == 64);

/// The lit lights of a table in groups of neighbours, subtrees of one light BVH.
struct LightGroups {
    static constexpr std::uint32_t kNoGroup = 0xffffffffu;

    LightBvh<MeansNode> bvh;
    std::vector<LightGroup> groups;
    std::vector<LightBvhSlot> slots;      ///< slot that stands for a group, by group
    std::vector<std::uint32_t> group_of;  ///< group of a light, by light; kNoGroup for a light of
                                          ///< intensity 0

    /// The groups, as a RangeTree takes them.
    std::vector<RangedLight> ranged() const;

    /// Puts groups[order[i]] in place i.
    void reorder(const std::vector<std::uint32_t>& order);

    std::size_t memory_size() const noexcept;
};

/// Fits the groups to lights that have changed, all of which must have a place in `groups.bvh`.
/// Runs in the caller's TBB arena.
void refit_light_groups(LightGroups& groups, const LightTable& table);

/// Makes groups of at most max_size lights each, as large as the tree allows. Runs in the caller's
/// TBB arena.
LightGroups make_light_groups(const LightTable& table, std::uint32_t max_size);

/// The group size with which selection costs least for its error, found by trial: single lights
/// where there are few, else so that there are some hundred groups or more.
std::uint32_t suitable_group_size(std::size_t lights) noexcept;

/// The importance g of [TH16] Eq. 9 of all lights of a group, 0 only where none of them reaches the
/// point.
float importance(const LightGroup& group, const Receiver& receiver) noexcept;

}  // namespace lightcull
