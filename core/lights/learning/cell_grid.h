#pragma once

#include <lightcull/float3.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightcull {

/// The name of a cell: a cube of space, of points whose normals have the same main axis. A cell of
/// level l is divided into eight of level l + 1.
using CellKey = std::uint64_t;

/// A place among the cells.
struct CellPlace {
    float at[3];         ///< coordinates in edges of the finest cells
    std::uint32_t axis;  ///< main axis of the normal, with its sign: 0 to 5; 6: there is no normal
};

/// How space is divided into cells. Lengths are in the units of the lights.
class CellLattice {
  public:
    static constexpr std::uint32_t kFinest = 9;  ///< finest level

    /// edge: that of the cells of level 0.
    explicit CellLattice(float edge) noexcept;

    float edge(std::uint32_t level) const noexcept;
    CellPlace place(const float3& position, const float3& normal) const noexcept;
    /// The corner of a cell with the least coordinates.
    float3 corner(CellKey key) const noexcept;

    static CellKey key(const CellPlace& place, std::uint32_t level) noexcept;
    static std::uint32_t level_of(CellKey key) noexcept;
    /// The cell of a level that is the one of the key, or that this one is part of.
    static CellKey ancestor(CellKey key, std::uint32_t level) noexcept;
    /// The one of the eight parts of its parent that a cell of level 1 or more is.
    static std::uint32_t octant_of(CellKey key) noexcept;

  private:
    float edge_, scale_;
};

/// A place at random within half a cell of a level, but for the main axis of the normal, so that no
/// edge of a cell is seen. The position decides it.
CellPlace jittered(CellPlace place, std::uint32_t level, const float3& position) noexcept;

/// The cells there are.
class CellTree {
  public:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(keys_.size()); }
    CellKey key(std::uint32_t cell) const noexcept { return keys_[cell]; }
    std::uint32_t level(std::uint32_t cell) const noexcept {
        return CellLattice::level_of(keys_[cell]);
    }
    bool is_divided(std::uint32_t cell) const noexcept { return divided_[cell] != 0; }

    /// The finest cell that a place lies in; kNone where there is no cell.
    std::uint32_t find(const CellPlace& place) const noexcept;

    /// True if find() is known to find this cell; false if it may find another.
    bool is_finest_of(std::uint32_t cell, const CellPlace& place) const noexcept {
        return divided_[cell] == 0 && CellLattice::key(place, level(cell)) == keys_[cell];
    }
    /// The cell that one of level 1 or more is part of; it is divided.
    std::uint32_t parent_of(CellKey key) const noexcept;

    /// True if add() may be called: the key makes sense, what it is part of is divided, and the
    /// cell is not there yet.
    bool may_add(CellKey key) const noexcept;
    /// Adds a cell and returns its number. The one that it is part of is divided.
    std::uint32_t add(CellKey key);
    /// Lets a cell have children.
    void divide(std::uint32_t cell);

    std::size_t memory_size() const noexcept;

  private:
    static constexpr CellKey kEmpty = ~CellKey{0};
    /// A cell that is not divided; or kDivided | the place in parts_ of one that is; or kNone.
    using Link = std::uint32_t;
    static constexpr Link kDivided = 0x80000000u;

    /// The parts of a cell that is divided.
    struct Parts {
        static constexpr std::uint32_t kCount = 8;
        std::uint32_t whole;  ///< the cell
        Link of[kCount];
    };
    struct Root {
        CellKey key = kEmpty;
        Link link = kNone;
    };

    const Link* link_of_root(CellKey key) const noexcept;
    /// Where it is written how to get to a cell of a key that is there, or is a part of one that is
    /// divided; null for others.
    const Link* find_link(CellKey key) const noexcept;
    Link& link_of(CellKey key) noexcept;
    void enter(const Root& root) noexcept;
    void add_root(CellKey key);

    std::vector<Root> roots_;  ///< a power of 2 of them, searched one after the other
    std::size_t root_count_ = 0;
    std::vector<CellKey> keys_;
    std::vector<std::uint8_t> divided_;
    std::vector<Parts> parts_;
};

}  // namespace lightcull
