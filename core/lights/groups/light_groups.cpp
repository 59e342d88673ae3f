#include "lights/groups/light_groups.h"

#include <algorithm>
#include <utility>

#include "base/memory_size.h"
#include "lights/groups/group_kernels.h"

namespace lightcull {
namespace {

constexpr std::uint32_t kWidth = LightBvhNode::kWidth;

bool is_light(std::uint32_t child) noexcept {
    return (child & LightBvhNode::kLight) != 0;
}

class Grouping {
  public:
    Grouping(LightGroups& out, std::uint32_t max_size) : out_(out), max_size_(max_size) {
        // Nodes come before those below them.
        sizes_.resize(out.bvh.nodes.size());
        for (std::size_t n = sizes_.size(); n-- > 0;) {
            for (const std::uint32_t child : out.bvh.nodes[n].child) {
                if (child != LightBvhNode::kEmpty) sizes_[n] += size_of_child(child);
            }
        }
    }

    void divide(std::uint32_t n) {
        const MeansNode& node = out_.bvh.nodes[n];
        for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
            const std::uint32_t child = node.child[slot];
            if (child == LightBvhNode::kEmpty) continue;
            if (size_of_child(child) > max_size_) {
                divide(child);
                continue;
            }
            const auto group = static_cast<std::uint32_t>(out_.groups.size());
            out_.groups.emplace_back().set(0, node, slot);
            out_.slots.push_back(n * kWidth + slot);
            give(child, group);
        }
    }

  private:
    std::uint32_t size_of_child(std::uint32_t child) const noexcept {
        return is_light(child) ? 1 : sizes_[child];
    }

    /// Gives all lights under a child to the group.
    void give(std::uint32_t child, std::uint32_t group) {
        if (is_light(child)) {
            out_.group_of[child & ~LightBvhNode::kLight] = group;
            return;
        }
        for (const std::uint32_t below : out_.bvh.nodes[child].child) {
            if (below != LightBvhNode::kEmpty) give(below, group);
        }
    }

    LightGroups& out_;
    std::uint32_t max_size_;
    std::vector<std::uint32_t> sizes_;
};

}  // namespace

LightGroups make_light_groups(const LightTable& table, std::uint32_t max_size) {
    LightGroups result;
    result.bvh = build_light_bvh<MeansNode>(table);
    result.group_of.resize(table.records.size(), LightGroups::kNoGroup);
    if (!result.bvh.nodes.empty()) Grouping(result, max_size).divide(0);
    return result;
}

void refit_light_groups(LightGroups& groups, const LightTable& table) {
    refit_light_bvh(groups.bvh, table);
    for (std::size_t i = 0; i < groups.groups.size(); ++i) {
        const LightBvhSlot slot = groups.slots[i];
        groups.groups[i].set(0, groups.bvh.nodes[slot / kWidth], slot % kWidth);
    }
}

std::uint32_t suitable_group_size(std::size_t lights) noexcept {
    constexpr std::size_t kGroups = 400, kMostLights = 128;
    return static_cast<std::uint32_t>(std::clamp(lights / kGroups, std::size_t{1}, kMostLights));
}

std::vector<RangedLight> LightGroups::ranged() const {
    std::vector<RangedLight> lights;
    lights.reserve(groups.size());
    for (const LightGroup& group : groups) lights.push_back(group.ranged());
    return lights;
}

void LightGroups::reorder(const std::vector<std::uint32_t>& order) {
    std::vector<LightGroup> ordered;
    std::vector<LightBvhSlot> ordered_slots;
    ordered.reserve(groups.size());
    ordered_slots.reserve(groups.size());
    std::vector<std::uint32_t> place(groups.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        ordered.push_back(groups[order[i]]);
        ordered_slots.push_back(slots[order[i]]);
        place[order[i]] = i;
    }
    groups = std::move(ordered);
    slots = std::move(ordered_slots);
    for (std::uint32_t& group : group_of) {
        if (group != kNoGroup) group = place[group];
    }
}

std::size_t LightGroups::memory_size() const noexcept {
    return size_of(bvh.nodes) + size_of(bvh.parents) + size_of(bvh.slots) + size_of(groups) +
           size_of(slots) + size_of(group_of);
}

float importance(const LightGroup& group, const Receiver& receiver) noexcept {
    return group_kernels().importance(group, receiver);
}

}  // namespace lightcull
