#include "lights/learning/light_rows.h"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace lightcull {
namespace {

/// A row without lights.
LightRows::Row empty_row() noexcept {
    LightRows::Row row{};
    std::fill(std::begin(row.spread), std::end(row.spread), 1.0f);
    std::fill(std::begin(row.child), std::end(row.child), LightBvhNode::kEmpty);
    return row;
}

}  // namespace

LightRows::LightRows(const LightBvh<MeansNode>& bvh, const LeafOrder& leaves)
    : rows_((leaves.size() + kColumns - 1) / kColumns, empty_row()) {
    assert(leaves.size() > 0 && leaves.size() <= kMost);
    for (const LightBvhSlot slot : bvh.slots) {
        if (slot == LightBvh<MeansNode>::kNoSlot) continue;
        const std::size_t place = place_of_leaf(leaves.first(slot));
        rows_[place / kColumns].set(place % kColumns, bvh.nodes[slot / LightBvhNode::kWidth],
                                    slot % LightBvhNode::kWidth);
    }
}

void LightFactors::set(const LightRows& lights, const LeafOrder& leaves,
                       const ClusterCut& cut) noexcept {
    const auto rows = static_cast<std::uint32_t>(lights.rows().size());
    std::fill_n(of, rows * LightRows::kColumns, 0.0f);
    for (std::uint32_t i = 0; i < cut.size; ++i) {
        const std::uint32_t end = i + 1 < cut.size ? cut.first_leaf[i + 1] : leaves.size();
        std::size_t place = lights.place_of_leaf(cut.first_leaf[i]);
        for (std::uint32_t leaf = cut.first_leaf[i]; leaf < end; ++leaf) {
            of[place] = cut.visible[i];
            // Below the last row the next column begins.
            place += LightRows::kColumns;
            if (place >= rows * LightRows::kColumns) place -= rows * LightRows::kColumns - 1;
        }
    }
}

LightChoice choose(const LightRows& lights, const LightWeights& weights, double number) noexcept {
    constexpr std::size_t kColumns = LightRows::kColumns;
    double left = number * static_cast<double>(weights.total);
    // Rounding may leave a little at the end, which falls to what has any weight.
    std::size_t column = 0;
    double before = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < kColumns; ++i) {
        if (weights.columns[i] > 0.0f && sum <= left) {
            column = i;
            before = sum;
        }
        sum += static_cast<double>(weights.columns[i]);
    }
    left -= before;
    std::size_t chosen = column;
    sum = 0.0;
    for (std::size_t row = 0; row < lights.rows().size(); ++row) {
        const std::size_t place = row * kColumns + column;
        if (weights.of[place] > 0.0f && sum <= left) chosen = place;
        sum += static_cast<double>(weights.of[place]);
    }
    return {lights.child(chosen),
            static_cast<double>(weights.of[chosen]) / static_cast<double>(weights.total)};
}

}  // namespace lightcull
