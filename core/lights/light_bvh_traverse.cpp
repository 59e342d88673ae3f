#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lights/light_bvh_traverse.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h, which includes this file once per instruction set.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>

#include "lights/light_bvh_importance-inl.h"
#include "lights/light_bvh_traverse.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// How the choice falls among a node's children.
struct Shares {
    LightBvhImportances importances;
    double sums[kWidth];  ///< of the importances up to and with each

    template <typename Node>
    HWY_ATTR Shares(const Node& node, const LightBvhPoint& point) {
        importances_here(node, point, importances.of);
        // In double precision, where each importance above 0 raises the sum.
        double sum = 0.0;
        for (std::size_t i = 0; i < kWidth; ++i) {
            sum += static_cast<double>(importances.of[i]);
            sums[i] = sum;
        }
    }
    double total() const { return sums[kWidth - 1]; }
    double prob(std::size_t i) const { return static_cast<double>(importances.of[i]) / total(); }
    /// The child that `place` falls on; it becomes the place within that child's share. No child of
    /// importance 0 is chosen, and total() must not be 0.
    HWY_ATTR std::size_t choose(double& place) const {
        const double target = place * total();
        std::size_t chosen = 0;
        for (std::size_t i = 0; i + 1 < kWidth; ++i) chosen += sums[i] <= target ? 1 : 0;
        const double before = chosen > 0 ? sums[chosen - 1] : 0.0;
        constexpr double kBelowOne = 1.0 - 0x1p-53;
        place =
            std::min((target - before) / static_cast<double>(importances.of[chosen]), kBelowOne);
        return chosen;
    }
};

template <typename Node>
HWY_ATTR inline void prefetch(const Node& node) {
    constexpr std::size_t kLine = 64;
    const auto* bytes = reinterpret_cast<const char*>(&node);
    for (std::size_t at = 0; at < sizeof node; at += kLine) hwy::Prefetch(bytes + at);
}

/// One level down. False at the end of the way.
template <typename Node>
HWY_ATTR inline bool step(const LightBvh<Node>& bvh, LightBvhDescent& descent) {
    const Node& node = bvh.nodes[descent.child];
    const Shares shares(node, descent.point);
    if (!(shares.total() > 0.0)) {
        descent.prob = 0.0;
        return false;
    }
    const std::size_t chosen = shares.choose(descent.place);
    descent.prob *= shares.prob(chosen);
    descent.child = node.child[chosen];
    if ((descent.child & LightBvhNode::kLight) != 0) return false;
    prefetch(bvh.nodes[descent.child]);
    return true;
}

template <typename Node>
HWY_ATTR HWY_INLINE void descend_here(const LightBvh<Node>& bvh, Span<LightBvhDescent> descents) {
    LightBvhDescent* under_way[kMaxDescents];
    std::size_t count = descents.size();
    for (std::size_t i = 0; i < count; ++i) under_way[i] = &descents[i];
    while (count > 0) {
        std::size_t left = 0;
        for (std::size_t i = 0; i < count; ++i) {
            under_way[left] = under_way[i];
            left += step(bvh, *under_way[left]) ? 1 : 0;
        }
        count = left;
    }
}

template <typename Node>
HWY_ATTR HWY_INLINE double prob_of_light_here(const LightBvh<Node>& bvh, const LightBvhPoint& point,
                                              std::uint32_t light) {
    LightBvhSlot path[LightBvh<Node>::kMaxDepth];
    std::size_t depth = 0;
    for (LightBvhSlot slot = bvh.slots[light]; slot != LightBvh<Node>::kNoSlot;
         slot = bvh.parents[slot / kWidth]) {
        path[depth++] = slot;
    }
    if (depth == 0) return 0.0;
    double prob = 1.0;
    while (depth-- > 0) {
        const Shares shares(bvh.nodes[path[depth] / kWidth], point);
        if (!(shares.total() > 0.0)) return 0.0;
        prob *= shares.prob(path[depth] % kWidth);
    }
    return prob;
}

// Highway exports no overloads and, in the oldest version supported, no templates.
HWY_ATTR void importances_of_bounds(const BoundsNode& node, const LightBvhPoint& point,
                                    float* result) {
    importances_here(node, point, result);
}
HWY_ATTR void importances_of_means(const MeansNode& node, const LightBvhPoint& point,
                                   float* result) {
    importances_here(node, point, result);
}
HWY_ATTR void descend_bounds(const LightBvh<BoundsNode>& bvh, Span<LightBvhDescent> descents) {
    descend_here(bvh, descents);
}
HWY_ATTR void descend_means(const LightBvh<MeansNode>& bvh, Span<LightBvhDescent> descents) {
    descend_here(bvh, descents);
}
HWY_ATTR double prob_by_bounds(const LightBvh<BoundsNode>& bvh, const LightBvhPoint& point,
                               std::uint32_t light) {
    return prob_of_light_here(bvh, point, light);
}
HWY_ATTR double prob_by_means(const LightBvh<MeansNode>& bvh, const LightBvhPoint& point,
                              std::uint32_t light) {
    return prob_of_light_here(bvh, point, light);
}

}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lightcull {

HWY_EXPORT(importances_of_bounds);
HWY_EXPORT(importances_of_means);
HWY_EXPORT(descend_bounds);
HWY_EXPORT(descend_means);
HWY_EXPORT(prob_by_bounds);
HWY_EXPORT(prob_by_means);

LightBvhImportances importances(const BoundsNode& node, const LightBvhPoint& point) noexcept {
    LightBvhImportances result;
    HWY_DYNAMIC_DISPATCH(importances_of_bounds)(node, point, result.of);
    return result;
}
LightBvhImportances importances(const MeansNode& node, const LightBvhPoint& point) noexcept {
    LightBvhImportances result;
    HWY_DYNAMIC_DISPATCH(importances_of_means)(node, point, result.of);
    return result;
}

void descend(const LightBvh<BoundsNode>& bvh, Span<LightBvhDescent> descents) noexcept {
    HWY_DYNAMIC_DISPATCH(descend_bounds)(bvh, descents);
}
void descend(const LightBvh<MeansNode>& bvh, Span<LightBvhDescent> descents) noexcept {
    HWY_DYNAMIC_DISPATCH(descend_means)(bvh, descents);
}

double prob_of_light(const LightBvh<BoundsNode>& bvh, const LightBvhPoint& point,
                     std::uint32_t light) noexcept {
    return HWY_DYNAMIC_DISPATCH(prob_by_bounds)(bvh, point, light);
}
double prob_of_light(const LightBvh<MeansNode>& bvh, const LightBvhPoint& point,
                     std::uint32_t light) noexcept {
    return HWY_DYNAMIC_DISPATCH(prob_by_means)(bvh, point, light);
}

}  // namespace lightcull
#endif
