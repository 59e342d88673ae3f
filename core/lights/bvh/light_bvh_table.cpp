#include <lightcull/light_bvh_table.h>

#include "lights/bvh/light_bvh.h"
#include "lights/light/light_record.h"

namespace lightcull {
namespace {

static_assert(LightBvhTable::kWidth == LightBvhNode::kWidth);
static_assert(LightBvhTable::kLight == LightBvhNode::kLight);
static_assert(LightBvhTable::kEmpty == LightBvhNode::kEmpty);
static_assert(LightBvhTable::kNone == LightBvh<MeansNode>::kNoSlot);

float3 vector_of(const float (&of)[3][LightBvhNode::kWidth], std::size_t place) noexcept {
    return {of[0][place], of[1][place], of[2][place]};
}

LightBvhCluster cluster_at(const MeansNode& node, std::size_t place) noexcept {
    return {vector_of(node.center, place),
            node.radius[place],
            node.spread[place],
            node.intensity[place],
            vector_of(node.axis, place),
            node.apex[place],
            node.cosine[place],
            vector_of(node.mean_normal, place),
            node.diffuse[place],
            node.child[place]};
}

}  // namespace

LightBvhTable make_light_bvh_table(Span<const Light> lights) {
    const LightTable records = make_light_table(lights);
    LightBvh<MeansNode> bvh = build_light_bvh<MeansNode>(records);
    LightBvhTable table;
    table.origin = records.frame.origin;
    table.inv_scale = records.frame.inv_scale;
    table.clusters.reserve(bvh.nodes.size() * LightBvhTable::kWidth);
    for (const MeansNode& node : bvh.nodes) {
        for (std::size_t place = 0; place < LightBvhTable::kWidth; ++place) {
            table.clusters.push_back(cluster_at(node, place));
        }
    }
    table.parents = std::move(bvh.parents);
    table.leaves = std::move(bvh.slots);
    return table;
}

}  // namespace lightcull
