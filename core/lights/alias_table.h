#pragma once

#include <lightcull/span.h>

#include <cstdint>
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
    /// Bytes.
    std::size_t memory_size() const noexcept { return entries_.size() * sizeof(Entry); }

  private:
    struct Entry {
        float threshold;  ///< stay with this entry below it
        std::uint32_t alias;
        float prob;
    };
    std::vector<Entry> entries_;
};

}  // namespace lightcull
