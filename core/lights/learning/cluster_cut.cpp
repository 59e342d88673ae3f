#include "lights/learning/cluster_cut.h"

#include <algorithm>
#include <cassert>

namespace lightcull {

void ClusterCut::clear() noexcept {
    static_cast<ClusterMeans<kMaxSize>&>(*this) = {};
    std::fill(std::begin(spread), std::end(spread), 1.0f);
    std::fill(std::begin(child), std::end(child), LightBvhNode::kEmpty);
    std::fill(std::begin(visible), std::end(visible), 1.0f);
    std::fill(std::begin(first_leaf), std::end(first_leaf), 0xffffffffu);
    std::fill(std::begin(slot), std::end(slot), LightBvh<MeansNode>::kNoSlot);
    size = 0;
}

std::uint32_t ClusterCut::place_of_leaf(std::uint32_t leaf) const noexcept {
    // To count all is faster than to search: it takes no branch, and vectors do it.
    std::uint32_t count = 0;
    for (const std::uint32_t first : first_leaf) count += first <= leaf ? 1 : 0;
    assert(count > 0);
    return count - 1;
}

CutChoice choose(const CutWeights& weights, std::uint32_t size, double number) noexcept {
    constexpr std::uint32_t kStride = CutWeights::kStride;
    double left = number * static_cast<double>(weights.total());
    // Down the sums: rounding may leave a little at the end, which falls to what has any weight.
    const float* sums = weights.sums + 2 * kStride - 2;
    std::uint32_t column = 0;
    for (std::uint32_t half = 1; half < kStride; half *= 2) {
        sums -= 2 * half;
        const auto first = static_cast<double>(sums[column]);
        const bool second = left >= first && sums[column + half] > 0.0f;
        left -= second ? first : 0.0;
        column += second ? half : 0;
    }
    std::uint32_t chosen = column;
    double weight = 0.0;
    for (std::uint32_t i = column; i < size; i += kStride) {
        const auto w = static_cast<double>(weights.of[i]);
        if (!(w > 0.0)) continue;
        left -= weight;
        chosen = i;
        weight = w;
        if (left < w) break;
    }
    constexpr double kBelowOne = 1.0 - 0x1p-53;
    return {chosen, std::clamp(left / weight, 0.0, kBelowOne)};
}

}  // namespace lightcull
