// Included once per instruction set.
#if defined(LIGHTCULL_CUT_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_CUT_KERNELS_INL
#undef LIGHTCULL_CUT_KERNELS_INL
#else
#define LIGHTCULL_CUT_KERNELS_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <iterator>

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

/// The importances of clusters from the i-th on. blurred: as in mean_importance().
template <class D, std::size_t kCount>
HWY_ATTR HWY_INLINE hn::Vec<D> importances_at(D d, const ClusterMeans<kCount>& clusters,
                                              std::size_t i, const Receiver& receiver,
                                              hn::Vec<D>* blurred) {
    const ReceiverLanes<D, Receiver> receivers{receiver};
    const cluster::Ways<D> ways(receivers, clusters.center, i);
    const auto height = ways.height_over(receivers);
    const auto reached = cluster::may_reach(d, clusters, i, receivers, ways, height);
    const auto g = cluster::mean_importance(d, clusters, i, receivers, ways, height, blurred);
    return hn::IfThenElseZero(reached, g);
}

/// The weights of clusters of a cut from the i-th on.
HWY_ATTR HWY_INLINE hn::Vec<Tag> weights_at(const ClusterCut& cut, std::size_t i,
                                            const Receiver& receiver, hn::Vec<Tag>* blurred) {
    const Tag d;
    return hn::Mul(importances_at(d, cut, i, receiver, blurred), hn::Load(d, cut.scale + i));
}

/// True if a receiver is weighed by the importance alone: where it has a lobe, or is in a volume,
/// more varies over a cell than its cosine.
inline bool is_near_all(const Receiver& receiver) noexcept {
    return receiver.has_lobe() || receiver.from_all_sides > 0.0f;
}

/// The weights of far clusters from the i-th on.
HWY_ATTR HWY_INLINE hn::Vec<Tag> far_weights_at(const ClusterCut& cut, std::size_t i,
                                                const Receiver& receiver) {
    const Tag d;
    const ReceiverLanes<Tag, Receiver> receivers{receiver};
    const auto height = cluster::Ways<Tag>(receivers, cut.center, i).height_over(receivers);
    const auto received = cluster::softened(height, hn::Abs(hn::Load(d, cut.spread + i)));
    const auto above = hn::Gt(hn::Add(height, hn::Load(d, cut.radius + i)), receivers.horizon());
    const auto w = hn::Mul(received, hn::Load(d, cut.far_scale + i));
    return hn::IfThenElseZero(above, hn::Max(w, hn::Zero(d)));
}

/// The sums of runs.
struct alignas(64) RunSums {
    float of[CutWeights::kRuns];
};

/// Brings the sums of runs into order, and adds them up.
inline void add_up(const ClusterCut& cut, const RunSums& runs, CutWeights& weights) {
    constexpr std::size_t kRuns = CutWeights::kRuns;
    for (std::size_t i = 0; i < kRuns; ++i) weights.sums[i] = runs.of[cut.run[i]];
    const float* from = weights.sums;
    float* to = weights.sums + kRuns;
    for (std::size_t half = kRuns / 2; half > 0; half /= 2) {
        for (std::size_t i = 0; i < half; ++i) to[i] = from[i] + from[i + half];
        from = to;
        to += half;
    }
}

/// What of each weight is glossy and blurred by the spread of its cluster.
struct alignas(64) Blur {
    float of[CutWeights::kMaxSize];
    float most[CutWeights::kMaxSize / kStride];  ///< the largest of each kStride places
    float visible[CutWeights::kMaxOpened];       ///< factor of the children of an opened node
};

/// What is blurred of weights: of none nothing, though the part may be no number at a point on a
/// light without extent.
template <class D>
HWY_ATTR HWY_INLINE hn::Vec<D> blur_of(D d, hn::Vec<D> weights, hn::Vec<D> part) {
    return hn::IfThenElseZero(hn::Gt(weights, hn::Zero(d)), hn::Mul(weights, part));
}

/// Finds the largest anew of the places around one.
HWY_ATTR inline void find_most(Blur& blur, std::size_t place) {
    const Tag d;
    const std::size_t first = place / kStride * kStride;
    auto most = hn::Load(d, blur.of + first);
    for (std::size_t i = hn::Lanes(d); i < kStride; i += hn::Lanes(d)) {
        most = hn::Max(most, hn::Load(d, blur.of + first + i));
    }
    blur.most[place / kStride] = hn::GetLane(hn::MaxOfLanes(d, most));
}

/// The place of which most is blurred.
inline std::uint32_t most_blurred(const Blur& blur) {
    const auto block = std::max_element(std::begin(blur.most), std::end(blur.most));
    const float* of = blur.of + (block - std::begin(blur.most)) * static_cast<int>(kStride);
    while (*of != *block) ++of;
    return static_cast<std::uint32_t>(of - blur.of);
}

/// Puts the children of a node in the place of their cluster.
HWY_ATTR inline void open(const MeansNode& node, float visible, const Receiver& receiver,
                          CutWeights& weights, Blur& blur) {
    const hn::CappedTag<float, CutWeights::kWidth> d;
    const std::size_t first = weights.size;
    weights.size += CutWeights::kWidth;
    for (std::size_t i = 0; i < CutWeights::kWidth; i += hn::Lanes(d)) {
        auto blurred = hn::Zero(d);
        const auto w = hn::Mul(importances_at(d, node, i, receiver, &blurred), hn::Set(d, visible));
        hn::Store(w, d, weights.of + first + i);
        hn::Store(blur_of(d, w, blurred), d, blur.of + first + i);
    }
    find_most(blur, first);
}

/// Opens, as far as there is room, the clusters of which it is least known how much lies in the
/// lobe of the receiver.
HWY_ATTR inline void open_blurred(const LightBvh<MeansNode>& bvh, const ClusterCut& cut,
                                  const Receiver& receiver, CutWeights& weights, Blur& blur) {
    /// The share of all weight below which that does not matter.
    constexpr float kShare = 1.0f / 128;
    const float least = kShare * weights.total();
    while (weights.opened_count < CutWeights::kMaxOpened) {
        const std::uint32_t place = most_blurred(blur);
        if (!(blur.of[place] > least)) return;
        blur.of[place] = 0.0f;
        find_most(blur, place);
        const std::uint32_t child = weights.child(bvh, cut, place);
        if ((child & LightBvhNode::kLight) != 0) continue;
        const std::uint32_t k = weights.opened_count++;
        weights.opened[k] = child;
        blur.visible[k] = place < weights.first_opened
                              ? cut.visible[cut.cluster_at[place]]
                              : blur.visible[(place - weights.first_opened) / CutWeights::kWidth];
        weights.of[place] = 0.0f;
        open(bvh.nodes[child], blur.visible[k], receiver, weights, blur);
    }
}

HWY_ATTR inline void sum(const ClusterCut& cut, CutWeights& weights) {
    const Tag d;
    RunSums runs;
    const std::size_t bounds[] = {0, weights.near_size, weights.size};
    for (std::size_t part = 0; part < 2; ++part) {
        for (std::size_t column = 0; column < kStride; column += hn::Lanes(d)) {
            auto sum = hn::Zero(d);
            for (std::size_t i = bounds[part] + column; i < bounds[part + 1]; i += kStride) {
                sum = hn::Add(sum, hn::Load(d, weights.of + i));
            }
            hn::Store(sum, d, runs.of + part * kStride + column);
        }
    }
    add_up(cut, runs, weights);
}

HWY_ATTR inline void weigh_lobe(const LightBvh<MeansNode>& bvh, const ClusterCut& cut,
                                const Receiver& receiver, CutWeights& weights) {
    const Tag d;
    Blur blur;
    std::fill(std::begin(blur.of) + weights.size, std::end(blur.of), 0.0f);
    std::fill(std::begin(weights.of) + weights.size, std::end(weights.of), 0.0f);
    for (std::size_t i = 0; i < weights.size; i += hn::Lanes(d)) {
        auto blurred = hn::Zero(d);
        const auto w = weights_at(cut, i, receiver, &blurred);
        hn::Store(w, d, weights.of + i);
        hn::Store(blur_of(d, w, blurred), d, blur.of + i);
    }
    for (std::size_t i = 0; i < CutWeights::kMaxSize; i += kStride) find_most(blur, i);
    sum(cut, weights);
    open_blurred(bvh, cut, receiver, weights, blur);
    if (weights.opened_count > 0) sum(cut, weights);
}

HWY_ATTR inline void weigh(const LightBvh<MeansNode>& bvh, const ClusterCut& cut,
                           const Receiver& receiver, CutWeights& weights) {
    weights.size = static_cast<std::uint32_t>((cut.size + kStride - 1) / kStride * kStride);
    weights.first_opened = weights.size;
    weights.opened_count = 0;
    weights.near_size = is_near_all(receiver) ? weights.size : cut.near_size;
    if (receiver.has_lobe()) return weigh_lobe(bvh, cut, receiver, weights);
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    RunSums runs;
    for (std::size_t column = 0; column < kStride; column += lanes) {
        auto sum = hn::Zero(d);
        const auto add = [&](std::size_t i, hn::Vec<Tag> w) HWY_ATTR {
            hn::Store(w, d, weights.of + i);
            sum = hn::Add(sum, w);
        };
        std::size_t i = column;
        for (; i < weights.near_size; i += kStride) add(i, weights_at(cut, i, receiver, nullptr));
        hn::Store(sum, d, runs.of + column);
        sum = hn::Zero(d);
        for (; i < weights.size; i += kStride) add(i, far_weights_at(cut, i, receiver));
        hn::Store(sum, d, runs.of + kStride + column);
    }
    add_up(cut, runs, weights);
}

HWY_ATTR inline float weight_of(const ClusterCut& cut, std::uint32_t place,
                                const Receiver& receiver) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    const std::size_t first = place / lanes * lanes;
    HWY_ALIGN float weights[kStride];
    const bool near = is_near_all(receiver) || place < cut.near_size;
    hn::Store(
        near ? weights_at(cut, first, receiver, nullptr) : far_weights_at(cut, first, receiver), d,
        weights);
    return weights[place - first];
}

HWY_ATTR inline void weigh_lights(const LightRows& lights, const LightFactors& factors,
                                  const Receiver& receiver, LightWeights& weights) {
    static_assert(LightRows::kColumns == kStride);
    const Tag d;
    const std::size_t rows = lights.rows().size();
    for (std::size_t column = 0; column < kStride; column += hn::Lanes(d)) {
        auto sum = hn::Zero(d);
        for (std::size_t row = 0; row < rows; ++row) {
            const std::size_t at = row * kStride + column;
            const auto g = importances_at(d, lights.rows()[row], column, receiver, nullptr);
            const auto w = hn::Mul(g, hn::Load(d, factors.of + at));
            hn::Store(w, d, weights.of + at);
            sum = hn::Add(sum, w);
        }
        hn::Store(sum, d, weights.columns + column);
    }
    weights.total = 0.0f;
    for (const float sum : weights.columns) weights.total += sum;
}

HWY_ATTR inline float importance_of_light(const LightRows& lights, std::size_t place,
                                          const Receiver& receiver) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    const std::size_t column = place % kStride, first = column / lanes * lanes;
    HWY_ALIGN float g[kStride];
    hn::Store(importances_at(d, lights.rows()[place / kStride], first, receiver, nullptr), d, g);
    return g[column - first];
}

}  // namespace cut

constexpr CutKernels kCutKernels{cut::weigh, cut::weight_of, cut::weigh_lights,
                                 cut::importance_of_light};

inline const CutKernels& target_cut_kernels() {
    return kCutKernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
