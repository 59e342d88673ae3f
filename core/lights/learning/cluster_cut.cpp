#include "lights/learning/cluster_cut.h"

#include <algorithm>
#include <cassert>

namespace lightcull {

void ClusterCut::clear() noexcept {
    static_cast<ClusterMeans<kMaxSize>&>(*this) = {};
    std::fill(std::begin(spread), std::end(spread), 1.0f);
    std::fill(std::begin(child), std::end(child), LightBvhNode::kEmpty);
    std::fill(std::begin(visible), std::end(visible), 1.0f);
    std::fill(std::begin(scale), std::end(scale), 1.0f);
    std::fill(std::begin(far_scale), std::end(far_scale), 0.0f);
    std::fill(std::begin(place_of), std::end(place_of), std::uint8_t{0});
    std::fill(std::begin(cluster_at), std::end(cluster_at), std::uint8_t{0});
    std::fill(std::begin(run), std::end(run), std::uint8_t{0});
    std::fill(std::begin(first_leaf), std::end(first_leaf), 0xffffffffu);
    std::fill(std::begin(slot), std::end(slot), LightBvh<MeansNode>::kNoSlot);
    size = near_size = 0;
    by_light = false;
}

std::uint32_t ClusterCut::cluster_of_leaf(std::uint32_t leaf) const noexcept {
    static_assert((kMaxSize & (kMaxSize - 1)) == 0);
    assert(size > 0 && first_leaf[0] <= leaf);
    std::uint32_t cluster = 0;
    for (std::uint32_t step = kMaxSize / 2; step > 0; step /= 2) {
        cluster += first_leaf[cluster + step] <= leaf ? step : 0;
    }
    return cluster;
}

CutChoice choose(const ClusterCut& cut, const CutWeights& weights, double number) noexcept {
    constexpr std::size_t kStride = CutWeights::kStride, kRuns = CutWeights::kRuns;
    double left = number * static_cast<double>(weights.total());
    // Down the sums: rounding may leave a little at the end, which falls to what has any weight.
    // Nobody can predict what is chosen: numbers instead of branches.
    const float* sums = weights.sums + 2 * kRuns - 2;
    std::size_t at = 0;
    for (std::size_t half = 1; half < kRuns; half *= 2) {
        sums -= 2 * half;
        const auto first = static_cast<double>(sums[at]);
        const auto second =
            static_cast<int>(left >= first) & static_cast<int>(sums[at + half] > 0.0f);
        left -= first * second;
        at += half * static_cast<std::size_t>(second);
    }
    const std::size_t run = cut.run[at], part = run / kStride;
    const std::size_t bounds[] = {0, weights.near_size, weights.size};
    const std::size_t top = bounds[part] + run % kStride;
    double before[CutWeights::kMaxSize / kStride];
    double sum = 0.0;
    std::size_t begun = 0, rows = 0;
    for (std::size_t i = top; i < bounds[part + 1]; i += kStride) {
        before[rows++] = sum;
        begun += static_cast<std::size_t>(sum <= left);
        sum += static_cast<double>(weights.of[i]);
    }
    // The last cluster with any weight that begins before the place.
    std::size_t row = begun - 1;
    while (row > 0 && !(weights.of[top + row * kStride] > 0.0f)) --row;
    const std::size_t chosen = top + row * kStride;
    const double within = (left - before[row]) / static_cast<double>(weights.of[chosen]);
    constexpr double kBelowOne = 1.0 - 0x1p-53;
    return {static_cast<std::uint32_t>(chosen), std::clamp(within, 0.0, kBelowOne)};
}

}  // namespace lightcull
