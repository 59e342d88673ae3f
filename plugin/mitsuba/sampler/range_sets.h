#pragma once

#include <lightcull/sets.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace mitsuba::culling {

/// The set of random ranges that a path uses at its camera point, and where the sets of its later
/// points start.
struct PathSets {
    std::uint32_t camera = 0;
    std::uint32_t packet = 0;

    /// The set to use at the point after `depth` bounces.
    std::uint32_t at(std::uint32_t depth, std::uint32_t set_count) const {
        return depth == 0 ? camera : ::lightcull::set_of_packet(packet + depth, set_count);
    }
};

/// The samples that a pixel gets in a pass: a divisor of spp, `most` or less. They use different
/// sets of random ranges, which are rotations of each other, so that they repeat no error.
inline std::uint32_t samples_per_pass(std::uint32_t most, std::uint32_t spp,
                                      std::uint32_t range_sets) {
    most = std::clamp(most, 1u, spp);
    if (range_sets > 1) most = std::min(most, range_sets);
    while (spp % most != 0) --most;
    return most;
}

/// The samples of a pass, dealt to passes that grow from one sample on: 16 are 1, 1, 2, 4 and 8.
/// Each is a divisor of their sum.
inline std::vector<std::uint32_t> growing_parts(std::uint32_t samples) {
    std::vector<std::uint32_t> parts;
    for (; samples % 2 == 0; samples /= 2) parts.insert(parts.begin(), samples / 2);
    parts.insert(parts.begin(), samples, 1);
    return parts;
}

/// The sets that a sample of pixel (x, y) uses.
inline PathSets sets_of_sample(std::uint32_t x, std::uint32_t y, std::uint32_t sample,
                               std::uint32_t range_sets) {
    const std::uint32_t camera = ::lightcull::set_of_sample(x, y, sample, 0, range_sets);
    return {camera, x + 5 * y + 3 * sample};
}

/// The sets of all paths of a wavefront, in which the paths of a pixel follow each other, and the
/// pixels row by row.
struct SetPattern {
    std::uint32_t width = 1;    ///< pixels
    std::uint32_t samples = 1;  ///< of each pixel
    std::uint32_t range_sets = 1;

    PathSets sets(std::uint32_t path) const {
        const std::uint32_t pixel = path / samples;
        return sets_of_sample(pixel % width, pixel / width, path % samples, range_sets);
    }
};

}  // namespace mitsuba::culling
