// Included once per instruction set.
#if defined(LIGHTCULL_LIGHT_BVH_DESCEND_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_LIGHT_BVH_DESCEND_INL
#undef LIGHTCULL_LIGHT_BVH_DESCEND_INL
#else
#define LIGHTCULL_LIGHT_BVH_DESCEND_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>

#include "lights/bvh/light_bvh_descend.h"
#include "lights/bvh/light_bvh_importance-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace bvh {
namespace hn = hwy::HWY_NAMESPACE;

/// The shares of a node's children, among which the choice falls.
struct Shares {
    LightBvhImportances importances;
    double sums[kWidth + 1];  ///< sum of the importances before each child; at the end, that of all

    template <typename Node>
    HWY_ATTR Shares(const Node& node, const Receiver& receiver) {
        compute_importances(node, receiver, importances.of);
        // The sums are in double precision, where each importance above 0 raises the sum.
        sums[0] = 0.0;
        for (std::size_t i = 0; i < kWidth; ++i) {
            sums[i + 1] = sums[i] + static_cast<double>(importances.of[i]);
        }
    }
    double total() const { return sums[kWidth]; }
    double prob(std::size_t i) const { return static_cast<double>(importances.of[i]) / total(); }
    /// The child that `place` falls on; `place` becomes the place within that child's share. No
    /// child of importance 0 is chosen, and total() must not be 0.
    HWY_ATTR std::size_t choose(double& place) const {
        const double target = place * total();
        std::size_t chosen = 0;
        for (std::size_t i = 1; i < kWidth; ++i) chosen += sums[i] <= target ? 1 : 0;
        constexpr double kBelowOne = 1.0 - 0x1p-53;
        place = std::min((target - sums[chosen]) / static_cast<double>(importances.of[chosen]),
                         kBelowOne);
        return chosen;
    }
};

template <typename Node>
HWY_ATTR inline void prefetch(const Node& node) {
    constexpr std::size_t kLine = 64;
    const auto* bytes = reinterpret_cast<const char*>(&node);
    for (std::size_t at = 0; at < sizeof node; at += kLine) hwy::Prefetch(bytes + at);
}

/// Takes a descent one level down. False at the end of the way.
template <typename Node>
HWY_ATTR inline bool step(const LightBvh<Node>& bvh, LightBvhDescent& descent) {
    const Node& node = bvh.nodes[descent.child];
    const Shares shares(node, descent.receiver);
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
HWY_ATTR void descend(const LightBvh<Node>& bvh, Span<LightBvhDescent> descents) {
    LightBvhDescent* under_way[kMaxDescents];
    std::size_t count = 0;
    for (LightBvhDescent& descent : descents) {
        if ((descent.child & LightBvhNode::kLight) != 0) continue;
        prefetch(bvh.nodes[descent.child]);
        under_way[count++] = &descent;
    }
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
HWY_ATTR double prob_of_slot(const LightBvh<Node>& bvh, const Receiver& receiver, LightBvhSlot slot,
                             LightBvhSlot top, double prob) {
    LightBvhSlot path[LightBvh<Node>::kMaxDepth];
    std::size_t depth = 0;
    for (; slot != top; slot = bvh.parents[slot / kWidth]) path[depth++] = slot;
    while (depth-- > 0) {
        const Shares shares(bvh.nodes[path[depth] / kWidth], receiver);
        if (!(shares.total() > 0.0)) return 0.0;
        prob *= shares.prob(path[depth] % kWidth);
    }
    return prob;
}

}  // namespace bvh
}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
