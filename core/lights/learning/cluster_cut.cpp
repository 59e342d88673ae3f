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
    std::fill(std::begin(first_leaf), std::end(first_leaf), 0xffffffffu);
    std::fill(std::begin(slot), std::end(slot), LightBvh<MeansNode>::kNoSlot);
    size = 0;
}

std::uint32_t ClusterCut::place_of_leaf(std::uint32_t leaf) const noexcept {
    static_assert((kMaxSize & (kMaxSize - 1)) == 0);
    assert(size > 0 && first_leaf[0] <= leaf);
    std::uint32_t place = 0;
    for (std::uint32_t step = kMaxSize / 2; step > 0; step /= 2) {
        place += first_leaf[place + step] <= leaf ? step : 0;
    }
    return place;
}

CutChoice choose(const CutWeights& weights, double number) noexcept {
    constexpr std::size_t kStride = CutWeights::kStride;
    double left = number * static_cast<double>(weights.total());
    // Down the sums: rounding may leave a little at the end, which falls to what has any weight.
    const float* sums = weights.sums + 2 * kStride - 2;
    std::size_t column = 0;
    for (std::size_t half = 1; half < kStride; half *= 2) {
        sums -= 2 * half;
        const auto first = static_cast<double>(sums[column]);
        const bool second = left >= first && sums[column + half] > 0.0f;
        left -= second ? first : 0.0;
        column += second ? half : 0;
    }
    // The last cluster with any weight that begins before the place; without branches, which nobody
    // can predict.
    double sum = 0.0, before = 0.0, weight = 1.0;
    std::size_t chosen = column;
    for (std::size_t i = column; i < weights.size; i += kStride) {
        const auto w = static_cast<double>(weights.of[i]);
        const bool take = w > 0.0 && sum <= left;
        chosen = take ? i : chosen;
        before = take ? sum : before;
        weight = take ? w : weight;
        sum += w;
    }
    constexpr double kBelowOne = 1.0 - 0x1p-53;
    return {static_cast<std::uint32_t>(chosen),
            std::clamp((left - before) / weight, 0.0, kBelowOne)};
}

}  // namespace lightcull
