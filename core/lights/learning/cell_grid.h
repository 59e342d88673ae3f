#pragma once

#include <lightcull/float3.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightcull {

/// The name of a cell: a cube of space, of points whose normals have the same main axis. Cells of
/// level l are 2^l times as fine as those of level 0.
using CellKey = std::uint64_t;

/// How space is divided into cells. Lengths are in the units of the lights.
class CellLattice {
  public:
    static constexpr std::uint32_t kMaxLevel = 7;

    /// size: edge of the cells of level 0.
    explicit CellLattice(float size) noexcept : size_(size) {}

    float size(std::uint32_t level) const noexcept;
    CellKey key(const float3& position, const float3& normal, std::uint32_t level) const noexcept;
    /// The corner of a cell with the least coordinates.
    float3 corner(CellKey key) const noexcept;
    static std::uint32_t level_of(CellKey key) noexcept;

    /// A place at random within half a cell of `position`, across the main axis of the normal, so
    /// that no edge of a cell is seen; the position decides it.
    float3 jittered(const float3& position, const float3& normal,
                    std::uint32_t level) const noexcept;

  private:
    float size_;
};

/// A table of cells by their keys.
class CellTable {
  public:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    CellTable() : entries_(1) {}
    /// Numbers the keys in their order.
    explicit CellTable(const std::vector<CellKey>& keys);

    std::uint32_t find(CellKey key) const noexcept;

    std::size_t memory_size() const noexcept;

  private:
    static constexpr CellKey kEmpty = ~CellKey{0};
    struct Entry {
        CellKey key = kEmpty;
        std::uint32_t cell = kNone;
    };
    std::vector<Entry> entries_;  ///< a power of 2 of them, searched one after the other
};

}  // namespace lightcull
