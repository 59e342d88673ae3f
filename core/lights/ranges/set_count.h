#pragma once

#include <cstddef>
#include <cstdint>

namespace lightcull {

/// Throws Error unless `set_count` is a power of 4, 1 to kMaxSetCount.
void check_set_count(std::uint32_t set_count);

/// The number of sets for a scene and an image (design.md, "No banding"): more hide the pattern
/// better, but each has to be refitted per pass. ranges: number of ranges that a set has.
/// points_per_pass: 0 for a host that may never begin a second pass; it gets all that memory
/// allows.
std::uint32_t suitable_set_count(std::size_t lights, std::size_t ranges,
                                 std::uint32_t points_per_pass) noexcept;

}  // namespace lightcull
