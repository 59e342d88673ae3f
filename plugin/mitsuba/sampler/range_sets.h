#pragma once

#include <lightcull/light_sampler.h>

#include <algorithm>
#include <cstdint>

#include "paths/path_context.h"

namespace mitsuba::culling {

/// Whether a sampler's numbers are independent of each other, so that any seed gives as good ones.
template <typename Sampler>
bool is_independent(const Sampler* sampler) {
    return sampler->class_name() == "IndependentSampler";
}

/// How many samples a pixel gets in a pass: a divisor of spp, `most` or less. They use different
/// sets of random ranges, which are rotations of each other, so that they repeat no error.
inline std::uint32_t samples_per_pass(std::uint32_t most, std::uint32_t spp,
                                      std::uint32_t range_sets) {
    most = std::clamp(most, 1u, spp);
    if (range_sets > 1) most = std::min(most, range_sets);
    while (spp % most != 0) --most;
    return most;
}

/// The sets that a sample of pixel (x, y) uses; sample < 64.
inline PathSets sets_of_sample(std::uint32_t x, std::uint32_t y, std::uint32_t sample,
                               std::uint32_t range_sets) {
    // Bits 0, 2 and 4, moved together.
    const auto even_bits = [](std::uint32_t number) {
        return (number & 1u) | ((number >> 1) & 2u) | ((number >> 2) & 4u);
    };
    // Those of the pixel's neighbours: near ones first, which are the ones that differ most.
    const std::uint32_t camera =
        ::lightcull::set_of_pixel(x + even_bits(sample), y + even_bits(sample >> 1), range_sets);
    return {camera, x + 5 * y + 3 * sample};
}

/// The same for all paths of a wavefront, where those of a pixel follow each other, row by row.
struct SetPattern {
    std::uint32_t width = 1;    ///< pixels
    std::uint32_t samples = 1;  ///< of each
    std::uint32_t range_sets = 1;

    PathSets sets(std::uint32_t path) const {
        const std::uint32_t pixel = path / samples;
        return sets_of_sample(pixel % width, pixel / width, path % samples, range_sets);
    }
};

}  // namespace mitsuba::culling
