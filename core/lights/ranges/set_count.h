#pragma once

#include <cstddef>
#include <cstdint>

namespace lightcull {

inline constexpr std::uint32_t kMaxSetCount = 4096;

/// Throws Error unless it is a power of 4, 1 to kMaxSetCount.
void check_set_count(std::uint32_t set_count);

/// The number of sets for a scene and an image (DESIGN section 3, No banding): more hide the
/// pattern better, but each has to be refitted per pass.
std::uint32_t suitable_set_count(std::size_t lights, std::uint32_t points_per_pass) noexcept;

}  // namespace lightcull
