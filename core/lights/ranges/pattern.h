#pragma once

#include <cstdint>

/// The pattern in which the sets of random ranges are spread (design.md, "No banding"): sets lie in
/// a square pattern of pixels, the sets of one draw are rotations of one another by rank
/// / rotations, and neighbours in the pattern have ranks far apart.

namespace lightcull {

/// The logarithm to the base of 4 of set_count = 4^log4_sets, whose sets lie in a square of
/// 2^log4_sets pixels.
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

/// A map of the places where the sets of a pass lie, and of what each of them is: a rotation of a
/// draw. The square of a draw's rotations is repeated, with another draw each time.
class SetPattern {
  public:
    /// set_count: a power of 4.
    explicit constexpr SetPattern(std::uint32_t set_count) noexcept
        : log4_sets_(log4_of(set_count)),
          log4_rotations_(log4_sets_ < kMaxLog4Rotations ? log4_sets_ : kMaxLog4Rotations) {}

    constexpr std::uint32_t rotations() const noexcept { return 1u << (2 * log4_rotations_); }
    constexpr std::uint32_t draws() const noexcept {
        return 1u << (2 * (log4_sets_ - log4_rotations_));
    }
    /// The logarithm to the base of 2 of the number of pixels along the edge of the square of a
    /// draw's rotations.
    constexpr std::uint32_t log2_edge() const noexcept { return log4_rotations_; }

    /// The set at (x, y) of the pattern, which goes on beyond its edges.
    constexpr std::uint32_t set_at(std::uint32_t x, std::uint32_t y) const noexcept {
        const std::uint32_t mask = (1u << log4_sets_) - 1u;
        return ((y & mask) << log4_sets_) | (x & mask);
    }
    constexpr std::uint32_t rank_at(std::uint32_t x, std::uint32_t y) const noexcept {
        return bayer_rank(x, y, log4_rotations_);
    }

    constexpr std::uint32_t rank_of(std::uint32_t set) const noexcept {
        return rank_at(set, set >> log4_sets_);
    }
    constexpr std::uint32_t draw_of(std::uint32_t set) const noexcept {
        const std::uint32_t x = set & ((1u << log4_sets_) - 1u), y = set >> log4_sets_;
        return ((y >> log4_rotations_) << (log4_sets_ - log4_rotations_)) | (x >> log4_rotations_);
    }

    /// The set of a rank < rotations() and a draw < draws().
    constexpr std::uint32_t set_of(std::uint32_t rank, std::uint32_t draw) const noexcept {
        std::uint32_t x = 0, y = 0;
        for (std::uint32_t bit = 0; bit < log4_rotations_; ++bit) {
            const std::uint32_t pair = (rank >> (2 * (log4_rotations_ - 1 - bit))) & 3u;
            const std::uint32_t y_bit = pair & 1u, x_bit = (pair >> 1) ^ y_bit;
            x |= x_bit << bit;
            y |= y_bit << bit;
        }
        const std::uint32_t log2_draws = log4_sets_ - log4_rotations_;
        x |= (draw & ((1u << log2_draws) - 1u)) << log4_rotations_;
        y |= (draw >> log2_draws) << log4_rotations_;
        return set_at(x, y);
    }

  private:
    /// At most 256 rotations of a draw: more would not make up for lights whose numbers turn
    /// together.
    static constexpr std::uint32_t kMaxLog4Rotations = 4;

    std::uint32_t log4_sets_, log4_rotations_;
};

}  // namespace lightcull
