#pragma once

#include <lightcull/float3.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "lights/learning/cell_grid.h"

namespace lightcull {

/// A cell in which points were met.
struct MetCell {
    CellKey key;
    std::uint32_t count;     ///< number of points
    std::int64_t offset[3];  ///< sum of places within the cell, in kParts of its edge
    std::int64_t normal[3];  ///< sum of normals, times kParts

    static constexpr float kParts = 1024.0f;
};

/// Collects the cells in which points are met for which there is no cell yet. Sums are of integers,
/// so that the order of calls does not matter. Holds up to kCapacity cells; beyond, it is said to
/// be full, and what it holds depends on the order.
class NewCells {
  public:
    static constexpr std::uint32_t kCapacity = 1u << 15;

    NewCells() : entries_(new Entry[kSlots]) {}

    /// Adds a point; from any thread.
    void add(const CellLattice& lattice, CellKey key, const float3& position,
             const float3& normal) noexcept;

    bool full() const noexcept { return count_.load(std::memory_order_relaxed) > kCapacity; }
    bool empty() const noexcept { return count_.load(std::memory_order_relaxed) == 0; }
    /// The cells in the order of their keys.
    std::vector<MetCell> cells() const;
    /// Puts cells back that cells() gave.
    void restore(const std::vector<MetCell>& cells) noexcept;
    void clear() noexcept;

    static std::size_t memory_size() noexcept { return kSlots * sizeof(Entry); }

  private:
    static constexpr std::uint32_t kSlots = 2 * kCapacity;
    static constexpr CellKey kEmpty = ~CellKey{0};
    struct Entry {
        std::atomic<CellKey> key{kEmpty};
        std::atomic<std::uint32_t> count{0};
        std::atomic<std::int64_t> sums[6]{};
    };

    /// The entry of a key, or null where there is no room.
    Entry* entry_of(CellKey key) noexcept;

    std::unique_ptr<Entry[]> entries_;
    std::atomic<std::uint32_t> count_{0};  ///< number of keys, those without room included
};

}  // namespace lightcull
