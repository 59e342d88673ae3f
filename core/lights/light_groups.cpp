#include "lights/light_groups.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lights/importance.h"
#include "lights/memory_size.h"

namespace lightcull {
namespace {

constexpr std::uint32_t kWidth = LightBvhNode::kWidth;

float3 vector_of(const float (&of)[3][kWidth], std::size_t slot) noexcept {
    return {of[0][slot], of[1][slot], of[2][slot]};
}

LightGroup group_of_slot(const MeansNode& node, std::uint32_t slot) noexcept {
    LightGroup group{};
    group.center = vector_of(node.center, slot);
    group.radius = node.radius[slot];
    group.axis = vector_of(node.axis, slot);
    group.apex = node.apex[slot];
    group.mean_normal = vector_of(node.mean_normal, slot);
    group.diffuse = node.diffuse[slot];
    group.intensity = node.intensity[slot];
    group.spread = node.spread[slot];
    group.cosine = node.cosine[slot];
    group.child = node.child[slot];
    return group;
}

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
            out_.groups.push_back(group_of_slot(node, slot));
            if (!is_light(child)) out_.bvh.parents[child] = LightBvh<MeansNode>::kNoSlot;
            give(child, group);
        }
    }

  private:
    std::uint32_t size_of_child(std::uint32_t child) const noexcept {
        return is_light(child) ? 1 : sizes_[child];
    }

    /// All lights under a child belong to the group.
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

/// c + sqrt(c^2 + q).
float softened(float c, float q) noexcept {
    return c + std::sqrt(c * c + q);
}

}  // namespace

LightGroups make_light_groups(const LightTable& table, std::uint32_t max_size) {
    LightGroups result;
    result.bvh = build_light_bvh<MeansNode>(table);
    result.group_of.resize(table.records.size(), LightGroups::kNoGroup);
    if (!result.bvh.nodes.empty()) Grouping(result, max_size).divide(0);
    return result;
}

std::uint32_t suitable_group_size(std::size_t lights) noexcept {
    constexpr std::size_t kGroups = 256, kMostLights = 256;
    return static_cast<std::uint32_t>(std::clamp(lights / kGroups, std::size_t{1}, kMostLights));
}

std::vector<RangedLight> LightGroups::ranged() const {
    std::vector<RangedLight> lights;
    lights.reserve(groups.size());
    for (const LightGroup& group : groups) {
        lights.push_back({group.center, group.radius, group.intensity});
    }
    return lights;
}

void LightGroups::reorder(const std::vector<std::uint32_t>& order) {
    std::vector<LightGroup> ordered;
    ordered.reserve(groups.size());
    std::vector<std::uint32_t> place(groups.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        ordered.push_back(groups[order[i]]);
        place[order[i]] = i;
    }
    groups = std::move(ordered);
    for (std::uint32_t& group : group_of) {
        if (group != kNoGroup) group = place[group];
    }
}

std::size_t LightGroups::memory_size() const noexcept {
    return size_of(bvh.nodes) + size_of(bvh.parents) + size_of(bvh.slots) + size_of(groups) +
           size_of(group_of);
}

float importance(const LightGroup& group, const Approach& approach,
                 const LightBvhPoint& point) noexcept {
    const float3 way = approach.way;
    const float distance2 = approach.distance2;
    const float two_sided = std::copysign(1.0f, group.diffuse);  // -1: yes
    const auto one_or_both = [&](float c) { return std::max(-c, -(two_sided * c)); };
    const float height = dot(point.normal, way);
    const float along = one_or_both(dot(group.axis, way));

    // Of the way from the cone's apex: its part along the axis, and its square.
    const float from_apex = along + group.apex;
    const float from_apex2 = distance2 + group.apex * (along + from_apex);
    const bool inside = from_apex * std::abs(from_apex) >= group.cosine * from_apex2;
    if (!(height + group.radius > point.horizon && inside)) return 0.0f;

    const float spread = std::abs(group.spread);
    const float mean_distance2 = distance2 + spread;
    float received = softened(height, spread + point.from_all_sides * mean_distance2);
    if (point.peak > 0.0f) {
        const float root = std::sqrt(mean_distance2);
        const float inverse_root = 1.0f / root;
        const float cosine = dot(point.axis, way) * inverse_root;
        const float lobe =
            mean_of_lobe(point.peak, point.alpha2, cosine, spread * inverse_root * inverse_root);
        received = (root + root) * (point.diffuse * (0.5f * received * inverse_root) + lobe);
    }
    const float facing = one_or_both(dot(group.mean_normal, way));
    const float emitted =
        softened(facing, std::max(group.spread, 0.0f) + std::abs(group.diffuse) * mean_distance2);
    const float inverse = 1.0f / mean_distance2;
    // In this order nothing gets as large or small as a fourth power of the distance.
    return (group.intensity * (received * inverse)) * (emitted * inverse);
}

}  // namespace lightcull
