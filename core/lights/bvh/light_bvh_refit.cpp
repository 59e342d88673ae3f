#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/parallel_blocks.h"
#include "lights/bvh/light_bvh.h"
#include "lights/bvh/light_bvh_cluster.h"
#include "lights/bvh/light_bvh_slot.h"

namespace lightcull {
namespace {

constexpr std::size_t kWidth = LightBvhNode::kWidth;

/// The node at which each level of the tree begins, and the end of the last: nodes lie breadth
/// first.
template <typename Node>
std::vector<std::size_t> levels_of(const LightBvh<Node>& bvh) {
    std::vector<std::size_t> levels{0};
    std::size_t end = 1;
    while (end < bvh.nodes.size() || levels.back() < end) {
        const std::size_t begin = levels.back();
        levels.push_back(end);
        std::size_t last = end;
        for (std::size_t n = begin; n < end; ++n) {
            for (const std::uint32_t child : bvh.nodes[n].child) {
                if ((child & LightBvhNode::kLight) == 0) last = child + 1;
            }
        }
        if (last == end) break;
        end = last;
    }
    return levels;
}

/// Fills the slots of a node, and returns the cluster of all of them, which has intensity 0 if none
/// is lit. of_nodes: the clusters of the nodes below.
template <typename Node>
LightCluster refit(Node& node, const LightTable& table, const std::vector<LightCluster>& of_nodes) {
    LightCluster all;
    for (std::size_t place = 0; place < kWidth; ++place) {
        const std::uint32_t child = node.child[place];
        if (child == LightBvhNode::kEmpty) continue;
        const bool is_light = (child & LightBvhNode::kLight) != 0;
        const LightCluster cluster =
            is_light ? cluster_of(table.records[child & ~LightBvhNode::kLight]) : of_nodes[child];
        if (!(cluster.intensity > 0.0f)) {
            node.intensity[place] = 0.0f;  // a light that is not lit is never chosen
            continue;
        }
        fill_slot(node, place, cluster, is_light ? SlotKind::kLight : SlotKind::kNode);
        all = all.intensity > 0.0f ? merge(all, cluster) : cluster;
    }
    return all;
}

template <typename Node>
bool holds_suns(const Node& node, std::size_t place) noexcept {
    const float3 center{node.center[0][place], node.center[1][place], node.center[2][place]};
    return far_distance2(center, node.radius[place] * node.radius[place]) > 1.0f;
}

}  // namespace

template <typename Node>
void refit_light_bvh(LightBvh<Node>& bvh, const LightTable& table) {
    if (bvh.nodes.empty()) return;
    const std::vector<std::size_t> levels = levels_of(bvh);
    std::vector<LightCluster> of_nodes(bvh.nodes.size());
    constexpr std::size_t kBlock = 64;
    for (std::size_t level = levels.size() - 1; level-- > 0;) {
        const std::size_t begin = levels[level], size = levels[level + 1] - begin;
        for_each_block(size, kBlock, [&](std::size_t first, std::size_t end) {
            for (std::size_t n = begin + first; n < begin + end; ++n) {
                of_nodes[n] = refit(bvh.nodes[n], table, of_nodes);
            }
        });
    }
}

template <typename Node>
double looseness(const LightBvh<Node>& bvh) noexcept {
    double sum = 0.0, of_root = 0.0, low[3], high[3];
    for (std::size_t k = 0; k < 3; ++k) low[k] = 1e300, high[k] = -1e300;
    for (std::size_t n = 0; n < bvh.nodes.size(); ++n) {
        const Node& node = bvh.nodes[n];
        for (std::size_t place = 0; place < kWidth; ++place) {
            const auto intensity = static_cast<double>(node.intensity[place]);
            if (!(intensity > 0.0)) continue;
            if (holds_suns(node, place)) continue;
            const auto radius = static_cast<double>(node.radius[place]);
            const bool inner = (node.child[place] & LightBvhNode::kLight) == 0;
            if (inner) sum += intensity * radius * radius;
            if (n > 0) continue;
            of_root += intensity;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto center = static_cast<double>(node.center[k][place]);
                low[k] = std::fmin(low[k], center - radius);
                high[k] = std::fmax(high[k], center + radius);
            }
        }
    }
    double extent2 = 0.0;
    for (std::size_t k = 0; k < 3; ++k) extent2 += (high[k] - low[k]) * (high[k] - low[k]);
    const double whole = of_root * extent2;
    return whole > 0.0 && std::isfinite(whole) ? sum / whole : 0.0;
}

template void refit_light_bvh(LightBvh<BoundsNode>& bvh, const LightTable& table);
template void refit_light_bvh(LightBvh<MeansNode>& bvh, const LightTable& table);
template double looseness(const LightBvh<BoundsNode>& bvh) noexcept;
template double looseness(const LightBvh<MeansNode>& bvh) noexcept;

}  // namespace lightcull
