#pragma once

#include <lightcull/triangle_cuts.h>

#include <cstdint>

namespace lightcull {

inline std::uint32_t next_corner(std::uint32_t corner) noexcept {
    return corner == 2 ? 0 : corner + 1;
}

/// One half of a triangle: the middle of the edge from `edge` to the next corner takes the place of
/// the next corner, or, in the second half, of this one. Halves of halves are exact as long as
/// floats hold the powers of 2.
inline SubTriangle half_of(const SubTriangle& whole, std::uint32_t edge, bool second) noexcept {
    const float2 a = whole.corners[edge], b = whole.corners[next_corner(edge)];
    SubTriangle half = whole;
    half.corners[second ? edge : next_corner(edge)] = {0.5f * (a.x + b.x), 0.5f * (a.y + b.y)};
    return half;
}

}  // namespace lightcull
