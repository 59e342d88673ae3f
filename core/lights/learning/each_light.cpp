#include <algorithm>

#include "base/float3_math.h"
#include "lights/bvh/light_bvh_kernels.h"
#include "lights/learning/cut_builder.h"
#include "lights/learning/cut_kernels.h"
#include "lights/learning/light_rows.h"

// Whether it pays to weigh each light.

namespace lightcull {
namespace {

constexpr std::uint32_t kWidth = LightBvhNode::kWidth;

/// What the lights of a cluster give a receiver.
struct Given {
    double sum = 0.0;      ///< sum of their importances
    double squares = 0.0;  ///< sum of the squares of these, each over the light's probability
};

/// Adds the lights of a child of importance `importance`, which is chosen with a probability.
void add(const LightBvh<MeansNode>& bvh, const Receiver& x, std::uint32_t child, double importance,
         double prob, Given& given) noexcept {
    if ((child & LightBvhNode::kLight) != 0) {
        given.sum += importance;
        given.squares += importance * importance / prob;
        return;
    }
    const MeansNode& node = bvh.nodes[child];
    LightBvhImportances g;
    light_bvh_kernels<MeansNode>().importances(node, x, g.of);
    double total = 0.0;
    for (const float weight : g.of) total += static_cast<double>(weight);
    for (std::uint32_t i = 0; i < kWidth; ++i) {
        const auto weight = static_cast<double>(g.of[i]);
        if (!(weight > 0.0)) continue;
        add(bvh, x, node.child[i], weight, prob * (weight / total), given);
    }
}

/// Sums over the clusters of a cut, of which each is visible in part.
struct Moments {
    double mean = 0.0;
    double second_by_cut = 0.0;  ///< second moment of a sample where the cut is used
    double root_by_each = 0.0;   ///< root of that where each light is weighed
};

Moments moments_at(const LightBvh<MeansNode>& bvh, const ClusterCut& cut,
                   const Receiver& x) noexcept {
    CutWeights weights;
    cut_kernels().weigh(bvh, cut, x, weights);
    Moments moments;
    for (std::uint32_t i = 0; i < cut.size; ++i) {
        const auto weight = static_cast<double>(weights.of[cut.place_of[i]]);
        if (!(weight > 0.0)) continue;
        const MeansNode& node = bvh.nodes[cut.slot[i] / kWidth];
        LightBvhImportances g;
        light_bvh_kernels<MeansNode>().importances(node, x, g.of);
        const std::uint32_t child = cut.slot[i] % kWidth;
        Given given;
        add(bvh, x, node.child[child], static_cast<double>(g.of[child]),
            weight / static_cast<double>(weights.total()), given);
        const auto factor = static_cast<double>(cut.visible[i]), visible = factor * factor;
        moments.mean += visible * given.sum;
        moments.second_by_cut += visible * given.squares;
        moments.root_by_each += factor * given.sum;
    }
    return moments;
}

}  // namespace

bool gains_by_each_light(const LightBvh<MeansNode>& bvh, std::uint32_t light_count,
                         const CutPlace& place, const ClusterCut& cut) noexcept {
    // A sample that weighs so many lights takes twice the time. Variance below kLeast is not seen.
    constexpr double kTwice = 1000.0, kLeast = 0.002;
    const double worth = 1.0 + light_count / kTwice;
    // Away from the middle, at corners of a tetrahedron.
    constexpr float kAway = 0.4f;
    constexpr float3 kCorners[]{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    double by_cut = 0.0, by_each = 0.0;
    for (const float3& corner : kCorners) {
        const float3 away = corner - place.normal * dot(place.normal, corner);
        const Receiver x(place.position + away * (kAway * place.radius), place.normal);
        const Moments moments = moments_at(bvh, cut, x);
        const double square = moments.mean * moments.mean;
        if (!(square > 0.0)) continue;
        by_cut += moments.second_by_cut / square - 1.0;
        by_each += moments.root_by_each * moments.root_by_each / square - 1.0;
    }
    return by_cut > worth * std::max(by_each, 0.0) + 4.0 * kLeast;
}

}  // namespace lightcull
