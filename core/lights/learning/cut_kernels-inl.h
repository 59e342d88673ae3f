// Included once per instruction set.
#if defined(LIGHTCULL_CUT_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_CUT_KERNELS_INL
#undef LIGHTCULL_CUT_KERNELS_INL
#else
#define LIGHTCULL_CUT_KERNELS_INL
#endif

#include <hwy/highway.h>

#include "lights/bvh/cluster_importance-inl.h"
#include "lights/learning/cut_kernels.h"
#include "lights/light/receiver_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace cut {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kStride = CutWeights::kStride;
using Tag = hn::CappedTag<float, kStride>;
using Receivers = ReceiverLanes<Tag, Receiver>;

/// The weights of clusters from the i-th on.
HWY_ATTR HWY_INLINE hn::Vec<Tag> weights_at(const ClusterCut& cut, std::size_t i,
                                            const Receivers& receivers) {
    const Tag d;
    const cluster::Ways<Tag> ways(receivers, cut.center, i);
    const auto height = ways.height_over(receivers);
    const auto reached = cluster::may_reach(d, cut, i, receivers, ways, height);
    const auto g = cluster::mean_importance(d, cut, i, receivers, ways, height);
    return hn::IfThenElseZero(reached, hn::Mul(g, hn::Load(d, cut.visible + i)));
}

HWY_ATTR inline void weigh(const ClusterCut& cut, const Receiver& receiver, CutWeights& weights) {
    const Tag d;
    const Receivers receivers{receiver};
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t column = 0; column < kStride; column += lanes) {
        auto sum = hn::Zero(d);
        for (std::size_t i = column; i < cut.size; i += kStride) {
            const auto w = weights_at(cut, i, receivers);
            hn::Store(w, d, weights.of + i);
            sum = hn::Add(sum, w);
        }
        hn::Store(sum, d, weights.sums + column);
    }
    const float* from = weights.sums;
    float* to = weights.sums + kStride;
    for (std::size_t half = kStride / 2; half > 0; half /= 2) {
        for (std::size_t i = 0; i < half; ++i) to[i] = from[i] + from[i + half];
        from = to;
        to += half;
    }
}

HWY_ATTR inline float weight_of(const ClusterCut& cut, std::uint32_t place,
                                const Receiver& receiver) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    const std::size_t first = place / lanes * lanes;
    HWY_ALIGN float weights[kStride];
    hn::Store(weights_at(cut, first, Receivers{receiver}), d, weights);
    return weights[place - first];
}

}  // namespace cut

constexpr CutKernels kCutKernels{cut::weigh, cut::weight_of};

inline const CutKernels& target_cut_kernels() {
    return kCutKernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
