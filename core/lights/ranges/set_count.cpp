#include "lights/ranges/set_count.h"

#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <string>

#include "lights/ranges/pattern.h"

namespace lightcull {
namespace {

/// The most sets that memory allows, for a host that may never begin a second pass.
std::uint32_t most_sets_of(std::size_t ranges) noexcept {
    constexpr std::size_t kMostBytes = std::size_t{64} << 20;
    constexpr std::uint32_t kFewest = 64;
    const std::size_t bytes_per_set = ranges * 5;  // the radii, in nodes that are not quite full
    std::uint32_t sets = kMaxSetCount;
    while (sets > kFewest && sets * bytes_per_set > kMostBytes) sets /= 4;
    return sets;
}

}  // namespace

void check_set_count(std::uint32_t set_count) {
    const bool in_range = set_count >= 1 && set_count <= kMaxSetCount;
    if (!in_range || (1u << (2 * log4_of(set_count))) != set_count) {
        throw Error("sets is " + std::to_string(set_count) + ", wanted a power of 4 from 1 to " +
                    std::to_string(kMaxSetCount));
    }
}

std::uint32_t suitable_set_count(std::size_t lights, std::size_t ranges,
                                 std::uint32_t points_per_pass) noexcept {
    constexpr std::uint32_t kFew = 16, kUsual = 64, kMany = 256;
    // With fewer points to a set, refits cost as much as selections, and packets spread.
    constexpr std::uint32_t kPointsPerSet = 4000;
    if (points_per_pass == 0) return most_sets_of(ranges);
    if (std::size_t{points_per_pass} * 3 < lights) return kFew;
    for (const std::uint32_t sets : {kMany, kUsual}) {
        if (points_per_pass / sets >= kPointsPerSet) return sets;
    }
    return kFew;
}

}  // namespace lightcull
