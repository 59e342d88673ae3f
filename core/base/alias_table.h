#pragma once

#include <lightcull/span.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace lightcull {

/// Draws an index in proportion to its weight in constant time (Vose 1991).
class AliasTable {
  public:
    AliasTable() = default;
    /// Weights are finite, not negative, and not all 0.
    explicit AliasTable(Span<const double> weights);

    bool empty() const noexcept { return entries_.empty(); }
    std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(entries_.size()); }
    /// u in [0, 1), with as many digits as the table has entries and more.
    std::uint32_t sample(double u) const noexcept;
    /// The probability with which sample() yields i: weight i / sum of weights.
    float prob(std::uint32_t i) const noexcept { return entries_[i].prob; }
    /// The memory that the table takes, bytes.
    std::size_t memory_size() const noexcept { return entries_.size() * sizeof(Entry); }

  private:
    struct Entry {
        float threshold;  ///< number below which a draw stays with this entry
        std::uint32_t alias;
        float prob;
    };
    std::vector<Entry> entries_;
};

inline AliasTable::AliasTable(Span<const double> weights) : entries_(weights.size()) {
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    assert(sum > 0.0);
    const auto n = static_cast<double>(weights.size());
    std::vector<double> scaled(weights.size());
    std::vector<std::uint32_t> small, large;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const auto index = static_cast<std::uint32_t>(i);
        scaled[i] = weights[i] / sum * n;
        entries_[i] = {1.0f, index, static_cast<float>(weights[i] / sum)};
        (scaled[i] < 1.0 ? small : large).push_back(index);
    }
    while (!small.empty() && !large.empty()) {
        const std::uint32_t poor = small.back(), rich = large.back();
        small.pop_back();
        entries_[poor].threshold = static_cast<float>(scaled[poor]);
        entries_[poor].alias = rich;
        scaled[rich] -= 1.0 - scaled[poor];
        if (scaled[rich] < 1.0) {
            large.pop_back();
            small.push_back(rich);
        }
    }
    // Rounding leaves entries of weight about 1 over; an entry of weight 0 must not be among them.
    const std::uint32_t heaviest = static_cast<std::uint32_t>(
        std::max_element(weights.begin(), weights.end()) - weights.begin());
    for (const std::uint32_t i : small) {
        if (weights[i] == 0.0) {
            entries_[i].threshold = 0.0f;
            entries_[i].alias = heaviest;
        }
    }
}

inline std::uint32_t AliasTable::sample(double u) const noexcept {
    const double place = u * static_cast<double>(entries_.size());
    const std::size_t i = std::min(static_cast<std::size_t>(place), entries_.size() - 1);
    const auto within = static_cast<float>(place - static_cast<double>(i));
    return within < entries_[i].threshold ? static_cast<std::uint32_t>(i) : entries_[i].alias;
}

}  // namespace lightcull
