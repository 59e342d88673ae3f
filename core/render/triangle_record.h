#pragma once

#include <cstdint>

namespace lightcull {

inline constexpr std::uint32_t kNone = 0xffffffffu;

struct TriangleRecord {
    std::uint32_t mesh = 0;
    std::uint32_t light = kNone;  ///< the light of the triangle, or of its first part
};

}  // namespace lightcull
