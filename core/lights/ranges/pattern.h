#pragma once

#include <cstdint>

/// Which set of random ranges a point uses, and how the sets are spread (DESIGN section 3, No
/// banding): sets are rotations of one another by rank / set_count, and neighbours in the pattern
/// have ranks far apart.

namespace lightcull {

/// set_count = 4^log4_sets lies in a square of 2^log4_sets pixels.
constexpr std::uint32_t log4_of(std::uint32_t set_count) noexcept {
    std::uint32_t log4 = 0;
    while (set_count > 1) {
        set_count >>= 2;
        ++log4;
    }
    return log4;
}

/// Bayer's ordered-dither rank of place (x, y) in a square of 4^log4_sets places.
constexpr std::uint32_t bayer_rank(std::uint32_t x, std::uint32_t y,
                                   std::uint32_t log4_sets) noexcept {
    std::uint32_t rank = 0;
    for (std::uint32_t bit = 0; bit < log4_sets; ++bit) {
        const std::uint32_t pair = ((((x ^ y) >> bit) & 1u) << 1) | ((y >> bit) & 1u);
        rank = (rank << 2) | pair;  // the lowest bits of the place weigh most
    }
    return rank;
}

constexpr std::uint32_t rank_of_set(std::uint32_t set, std::uint32_t log4_sets) noexcept {
    const std::uint32_t mask = (1u << log4_sets) - 1u;
    return bayer_rank(set & mask, set >> log4_sets, log4_sets);
}

constexpr std::uint32_t set_of_rank(std::uint32_t rank, std::uint32_t log4_sets) noexcept {
    std::uint32_t x = 0, y = 0;
    for (std::uint32_t bit = 0; bit < log4_sets; ++bit) {
        const std::uint32_t pair = (rank >> (2 * (log4_sets - 1 - bit))) & 3u;
        const std::uint32_t y_bit = pair & 1u, x_bit = (pair >> 1) ^ y_bit;
        x |= x_bit << bit;
        y |= y_bit << bit;
    }
    return (y << log4_sets) | x;
}

}  // namespace lightcull
