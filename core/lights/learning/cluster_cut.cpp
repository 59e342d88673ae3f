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
    const std::uint32_t* const after = std::upper_bound(first_leaf, first_leaf + size, leaf);
    assert(after != first_leaf);
    return static_cast<std::uint32_t>(after - first_leaf) - 1;
}

CutChoice choose(const CutWeights& weights, std::uint32_t size, double number) noexcept {
    constexpr std::size_t kStride = CutWeights::kStride;
    double left = number * static_cast<double>(weights.total);
    // Rounding may leave a little at the end, which falls to the last that has any weight.
    std::size_t column = 0, last = 0;
    for (; column < kStride; ++column) {
        const auto sum = static_cast<double>(weights.sums[column]);
        if (sum > 0.0) {
            last = column;
            if (left < sum) break;
        }
        left -= sum;
    }
    if (column == kStride) {
        column = last;
        left = static_cast<double>(weights.sums[column]);
    }
    std::size_t chosen = column;
    double weight = 0.0;
    for (std::size_t i = column; i < size; i += kStride) {
        const auto w = static_cast<double>(weights.of[i]);
        if (!(w > 0.0)) continue;
        chosen = i;
        weight = w;
        if (left < w) break;
        left -= w;
    }
    constexpr double kBelowOne = 1.0 - 0x1p-53;
    return {static_cast<std::uint32_t>(chosen), std::clamp(left / weight, 0.0, kBelowOne)};
}

}  // namespace lightcull
