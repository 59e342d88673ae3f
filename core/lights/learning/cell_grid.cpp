#include "lights/learning/cell_grid.h"

#include <algorithm>
#include <cmath>

#include "base/float3_math.h"
#include "base/memory_size.h"
#include "base/random.h"
#include "base/refine.h"

namespace lightcull {
namespace {

/// Cells lie off the origin, so that no edges lie along walls at round coordinates.
constexpr float kOffset = 0.3819660f;
constexpr std::uint32_t kBits = 16;
constexpr std::uint32_t kVolume = 6;

std::uint64_t digits(float x) noexcept {
    constexpr float kLimit = 32767.0f;
    const auto cell = static_cast<std::int32_t>(std::floor(std::clamp(x, -kLimit, kLimit)));
    return static_cast<std::uint64_t>(cell + 32768);
}

/// The axis that a normal is nearest to, with a sign: 0 to 5; kVolume: there is no normal.
std::uint32_t axis_of(const float3& n) noexcept {
    const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    if (!(x + y + z > 0.0f)) return kVolume;
    if (x >= y && x >= z) return n.x > 0.0f ? 0 : 1;
    if (y >= z) return n.y > 0.0f ? 2 : 3;
    return n.z > 0.0f ? 4 : 5;
}

}  // namespace

float CellLattice::size(std::uint32_t level) const noexcept {
    return std::ldexp(size_, -static_cast<int>(level));
}

CellKey CellLattice::key(const float3& position, const float3& normal,
                         std::uint32_t level) const noexcept {
    const float inverse = 1.0f / size(level);
    const auto digit = [&](float x) { return digits(x * inverse + kOffset); };
    CellKey key = (CellKey{level} << 3) | axis_of(normal);
    key = (key << kBits) | digit(position.x);
    key = (key << kBits) | digit(position.y);
    return (key << kBits) | digit(position.z);
}

float3 CellLattice::corner(CellKey key) const noexcept {
    const float edge = size(level_of(key));
    const auto coordinate = [&](std::uint32_t shift) {
        const auto digit = static_cast<std::int32_t>((key >> shift) & 0xffffu) - 32768;
        return (static_cast<float>(digit) - kOffset) * edge;
    };
    return {coordinate(2 * kBits), coordinate(kBits), coordinate(0)};
}

std::uint32_t CellLattice::level_of(CellKey key) noexcept {
    return static_cast<std::uint32_t>(key >> (3 * kBits + 3));
}

float3 CellLattice::jittered(const float3& position, const float3& normal,
                             std::uint32_t level) const noexcept {
    const std::uint64_t xy = (std::uint64_t{float_bits(position.x)} << 32) | float_bits(position.y);
    const std::uint64_t random = hash(xy, float_bits(position.z));
    const float edge = size(level);
    const auto shift = [&](std::uint32_t axis, std::uint32_t from) {
        if (axis_of(normal) / 2 == axis) return 0.0f;
        constexpr float kDigits = 0x1p-21f;
        const auto number = static_cast<float>((random >> from) & 0x1fffffu) * kDigits;
        return (number - 0.5f) * edge;
    };
    return position + float3{shift(0, 0), shift(1, 21), shift(2, 42)};
}

CellTable::CellTable(const std::vector<CellKey>& keys) {
    std::size_t size = 1;
    while (size < 2 * keys.size() + 1) size *= 2;
    entries_.resize(size);
    for (std::uint32_t cell = 0; cell < keys.size(); ++cell) {
        std::size_t at = mix(keys[cell]) & (size - 1);
        while (entries_[at].cell != kNone) at = (at + 1) & (size - 1);
        entries_[at] = {keys[cell], cell};
    }
}

std::uint32_t CellTable::find(CellKey key) const noexcept {
    const std::size_t mask = entries_.size() - 1;
    std::size_t at = mix(key) & mask;
    while (entries_[at].key != key) {
        if (entries_[at].key == kEmpty) return kNone;
        at = (at + 1) & mask;
    }
    return entries_[at].cell;
}

std::size_t CellTable::memory_size() const noexcept {
    return size_of(entries_);
}

}  // namespace lightcull
