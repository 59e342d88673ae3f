#include "lights/learning/cell_grid.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

#include "base/float3_math.h"
#include "base/memory_size.h"
#include "base/random.h"
#include "base/refine.h"

namespace lightcull {
namespace {

/// Cells lie off the origin, so that no edges lie along walls at round coordinates.
constexpr float kOffset = 0.3819660f;
/// The digits of a coordinate of the finest cells, and those that are below 0.
constexpr std::uint32_t kBits = 18, kMiddle = 1u << (kBits - 1);
constexpr std::uint32_t kVolume = 6;
constexpr float kFinestPerFirst = 1u << CellLattice::kFinest;

/// The number of a coordinate's cell of the finest level.
std::uint32_t digits(float at) noexcept {
    constexpr float kLimit = kMiddle - 1;
    return static_cast<std::uint32_t>(std::clamp(at, -kLimit, kLimit) +
                                      static_cast<float>(kMiddle));
}

/// The axis that a normal is nearest to, with a sign.
std::uint32_t axis_of(const float3& n) noexcept {
    const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    if (!(x + y + z > 0.0f)) return kVolume;
    if (x >= y && x >= z) return n.x > 0.0f ? 0 : 1;
    if (y >= z) return n.y > 0.0f ? 2 : 3;
    return n.z > 0.0f ? 4 : 5;
}

std::uint32_t digits_of(CellKey key, std::size_t k) noexcept {
    return static_cast<std::uint32_t>(key >> ((2 - k) * kBits)) & ((1u << kBits) - 1);
}

/// The key of the cell of a level that holds one of the finest.
CellKey key_of(std::uint32_t level, std::uint32_t axis, std::uint32_t x, std::uint32_t y,
               std::uint32_t z) noexcept {
    CellKey key = (CellKey{level} << 3) | axis;
    for (const std::uint32_t k : {x, y, z}) {
        key = (key << kBits) | (k >> (CellLattice::kFinest - level));
    }
    return key;
}

std::uint32_t octant(std::uint32_t x, std::uint32_t y, std::uint32_t z) noexcept {
    return (x & 1) | ((y & 1) << 1) | ((z & 1) << 2);
}

}  // namespace

CellLattice::CellLattice(float edge) noexcept : edge_(edge), scale_(kFinestPerFirst / edge) {
}

float CellLattice::edge(std::uint32_t level) const noexcept {
    return edge_ / static_cast<float>(1u << level);
}

CellPlace CellLattice::place(const float3& position, const float3& normal) const noexcept {
    constexpr float kFirst = kOffset * kFinestPerFirst;
    return {
        {position.x * scale_ + kFirst, position.y * scale_ + kFirst, position.z * scale_ + kFirst},
        axis_of(normal)};
}

float3 CellLattice::corner(CellKey key) const noexcept {
    const std::uint32_t up = kFinest - level_of(key);
    const float finest = edge(kFinest);
    const auto coordinate = [&](std::size_t k) {
        const auto at =
            static_cast<std::int32_t>(digits_of(key, k) << up) - static_cast<std::int32_t>(kMiddle);
        return (static_cast<float>(at) - kOffset * kFinestPerFirst) * finest;
    };
    return {coordinate(0), coordinate(1), coordinate(2)};
}

CellKey CellLattice::key(const CellPlace& place, std::uint32_t level) noexcept {
    return key_of(level, place.axis, digits(place.at[0]), digits(place.at[1]), digits(place.at[2]));
}

std::uint32_t CellLattice::level_of(CellKey key) noexcept {
    return static_cast<std::uint32_t>(key >> (3 * kBits + 3));
}

CellKey CellLattice::ancestor(CellKey key, std::uint32_t level) noexcept {
    const std::uint32_t up = kFinest - level_of(key);
    const auto axis = static_cast<std::uint32_t>(key >> (3 * kBits)) & 7u;
    return key_of(level, axis, digits_of(key, 0) << up, digits_of(key, 1) << up,
                  digits_of(key, 2) << up);
}

std::uint32_t CellLattice::octant_of(CellKey key) noexcept {
    return octant(digits_of(key, 0), digits_of(key, 1), digits_of(key, 2));
}

CellPlace jittered(CellPlace place, std::uint32_t level, const float3& position) noexcept {
    const std::uint64_t xy = (std::uint64_t{float_bits(position.x)} << 32) | float_bits(position.y);
    const std::uint64_t random = hash(xy, float_bits(position.z));
    const float edge = static_cast<float>(1u << (CellLattice::kFinest - level));
    for (std::uint32_t k = 0; k < 3; ++k) {
        if (k == place.axis / 2) continue;
        const auto number = static_cast<float>((random >> (21 * k)) & 0x1fffffu) * 0x1p-21f;
        place.at[k] += (number - 0.5f) * edge;
    }
    return place;
}

const CellTree::Link* CellTree::link_of_root(CellKey key) const noexcept {
    if (roots_.empty()) return nullptr;
    const std::size_t mask = roots_.size() - 1;
    std::size_t at = mix(key) & mask;
    while (roots_[at].key != key) {
        if (roots_[at].key == kEmpty) return nullptr;
        at = (at + 1) & mask;
    }
    return &roots_[at].link;
}

std::uint32_t CellTree::find(const CellPlace& place) const noexcept {
    const std::uint32_t x = digits(place.at[0]), y = digits(place.at[1]), z = digits(place.at[2]);
    const Link* root = link_of_root(key_of(0, place.axis, x, y, z));
    if (root == nullptr) return kNone;
    Link link = *root;
    for (std::uint32_t down = CellLattice::kFinest; (link & kDivided) != 0;) {
        const Parts& parts = parts_[link & ~kDivided];
        --down;
        link = parts.of[octant(x >> down, y >> down, z >> down)];
        if (link == kNone) return parts.whole;
    }
    return link;
}

const CellTree::Link* CellTree::find_link(CellKey key) const noexcept {
    const std::uint32_t level = CellLattice::level_of(key);
    const Link* link = link_of_root(CellLattice::ancestor(key, 0));
    for (std::uint32_t l = 1; l <= level && link != nullptr; ++l) {
        if (*link == kNone || (*link & kDivided) == 0) return nullptr;
        const Parts& parts = parts_[*link & ~kDivided];
        link = &parts.of[CellLattice::octant_of(CellLattice::ancestor(key, l))];
    }
    return link;
}

CellTree::Link& CellTree::link_of(CellKey key) noexcept {
    const Link* const link = find_link(key);
    assert(link != nullptr);
    return const_cast<Link&>(*link);
}

std::uint32_t CellTree::parent_of(CellKey key) const noexcept {
    const Link* const link = find_link(CellLattice::ancestor(key, CellLattice::level_of(key) - 1));
    assert(link != nullptr && (*link & kDivided) != 0);
    return parts_[*link & ~kDivided].whole;
}

bool CellTree::may_add(CellKey key) const noexcept {
    const std::uint32_t level = CellLattice::level_of(key);
    if (level > CellLattice::kFinest || key != CellLattice::ancestor(key, level)) return false;
    const Link* const link = find_link(key);
    return level == 0 ? link == nullptr : link != nullptr && *link == kNone;
}

std::uint32_t CellTree::add(CellKey key) {
    assert(may_add(key));
    const std::uint32_t cell = size();
    if (CellLattice::level_of(key) == 0) add_root(key);
    link_of(key) = cell;
    keys_.push_back(key);
    divided_.push_back(0);
    return cell;
}

void CellTree::enter(const Root& root) noexcept {
    const std::size_t mask = roots_.size() - 1;
    std::size_t at = mix(root.key) & mask;
    while (roots_[at].key != kEmpty) at = (at + 1) & mask;
    roots_[at] = root;
}

void CellTree::add_root(CellKey key) {
    if (2 * (root_count_ + 1) > roots_.size()) {
        std::vector<Root> before(std::max<std::size_t>(16, 2 * roots_.size()));
        before.swap(roots_);
        for (const Root& root : before) {
            if (root.key != kEmpty) enter(root);
        }
    }
    enter({key, kNone});
    ++root_count_;
}

void CellTree::divide(std::uint32_t cell) {
    assert(level(cell) < CellLattice::kFinest);
    if (is_divided(cell)) return;
    divided_[cell] = 1;
    link_of(keys_[cell]) = kDivided | static_cast<Link>(parts_.size());
    Parts parts{cell, {}};
    std::fill(std::begin(parts.of), std::end(parts.of), kNone);
    parts_.push_back(parts);
}

std::size_t CellTree::memory_size() const noexcept {
    return size_of(roots_) + size_of(keys_) + size_of(divided_) + size_of(parts_);
}

}  // namespace lightcull
