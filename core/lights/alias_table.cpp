#include "lights/alias_table.h"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace lightcull {

AliasTable::AliasTable(Span<const double> weights) : entries_(weights.size()) {
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
    // Rounding leaves entries of weight about 1 over; one of weight 0 must not be among them.
    const std::uint32_t heaviest = static_cast<std::uint32_t>(
        std::max_element(weights.begin(), weights.end()) - weights.begin());
    for (const std::uint32_t i : small) {
        if (weights[i] == 0.0) {
            entries_[i].threshold = 0.0f;
            entries_[i].alias = heaviest;
        }
    }
}

std::uint32_t AliasTable::sample(double u) const noexcept {
    const double place = u * static_cast<double>(entries_.size());
    const std::size_t i = std::min(static_cast<std::size_t>(place), entries_.size() - 1);
    const auto within = static_cast<float>(place - static_cast<double>(i));
    return within < entries_[i].threshold ? static_cast<std::uint32_t>(i) : entries_[i].alias;
}

}  // namespace lightcull
