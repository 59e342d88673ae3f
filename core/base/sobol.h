#pragma once

#include <cassert>
#include <cstdint>

#include "base/random.h"
#include "base/reversed_bits.h"

/// Sobol' points, scrambled as Owen does. All is arithmetic on integers, the same on any machine.

namespace lightcull {

/// A bijection in which a bit is flipped by a hash of the bits below it: nested uniform scrambling
/// (Owen 1995) of a fraction whose bits are reversed. The hash is that of Laine and Karras (2011,
/// "Stratified sampling for stochastic transparency", section 3.1) with the constants that
/// N. Vegdahl found (2021).
constexpr std::uint32_t scramble_upwards(std::uint32_t x, std::uint32_t seed) noexcept {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
}

/// The first dimensions of Sobol's sequence (1967), with the direction numbers of Joe and Kuo
/// (2008), for up to 2^16 points.
class SobolMatrices {
  public:
    static constexpr std::uint32_t kDimensions = 4;
    static constexpr std::uint32_t kBits = 16;

    constexpr SobolMatrices() noexcept {
        // Recurrences by primitive polynomials; a dimension's directions are m_k / 2^k.
        std::uint32_t m[kDimensions][kBits] = {{1}, {1}, {1, 3}, {1, 3, 1}};
        for (std::uint32_t k = 1; k < kBits; ++k) {
            m[0][k] = 1;
            m[1][k] = m[1][k - 1] << 1 ^ m[1][k - 1];
            if (k >= 2) m[2][k] = m[2][k - 1] << 1 ^ m[2][k - 2] << 2 ^ m[2][k - 2];
            if (k >= 3) m[3][k] = m[3][k - 2] << 2 ^ m[3][k - 3] << 3 ^ m[3][k - 3];
        }
        for (std::uint32_t d = 0; d < kDimensions; ++d) {
            for (std::uint32_t byte = 0; byte < kBits / 8; ++byte) {
                for (std::uint32_t value = 0; value < 256; ++value) {
                    std::uint32_t x = 0;
                    for (std::uint32_t bit = 0; bit < 8; ++bit) {
                        const std::uint32_t k = 8 * byte + bit;
                        if ((value >> bit & 1u) != 0) x ^= reversed_bits(m[d][k] << (31 - k));
                    }
                    columns_[d][byte][value] = static_cast<std::uint16_t>(x);
                }
            }
        }
    }

    /// A coordinate of the point of an index below 2^16, its bits reversed: bit 0 counts 1/2.
    constexpr std::uint32_t reversed_coordinate(std::uint32_t index,
                                                std::uint32_t dimension) const noexcept {
        return std::uint32_t{columns_[dimension][0][index & 0xffu]} ^
               columns_[dimension][1][index >> 8];
    }

  private:
    std::uint16_t columns_[kDimensions][kBits / 8][256]{};
};

inline constexpr SobolMatrices kSobol;

/// The place of a point in a sequence, made once for the points of many keys.
class SobolIndex {
  public:
    constexpr explicit SobolIndex(std::uint64_t index) noexcept
        : sequence_(index < kLength ? 0 : mix(index / kLength)),
          reversed_(reversed_bits(static_cast<std::uint32_t>(index % kLength))) {}

  private:
    friend class SobolPoint;
    static constexpr std::uint64_t kLength = std::uint64_t{1} << SobolMatrices::kBits;

    std::uint64_t sequence_;
    std::uint32_t reversed_;
};

/// A point of [0, 1)^4 from a sequence of its own for each key: Sobol's with its order shuffled and
/// its coordinates scrambled (Burley 2020, "Practical hash-based Owen scrambling"). Each point is
/// uniform, points of different keys are independent, and those of one key cover the cube evenly:
/// with the first 2^k of them, or any 2^k that begin at a multiple of that, each coordinate falls
/// once into each interval of length 2^-k, and so do pairs into boxes, about. That is so up to
/// 65,536 points, with which another sequence begins.
class SobolPoint {
  public:
    static constexpr std::uint32_t kDimensions = SobolMatrices::kDimensions;

    /// key: a hash, whose bits are all random.
    constexpr SobolPoint(std::uint64_t key, const SobolIndex& index) noexcept
        : key_(key ^ index.sequence_),
          index_(reversed_bits(
                     scramble_upwards(index.reversed_, static_cast<std::uint32_t>(key_ >> 32))) %
                 static_cast<std::uint32_t>(SobolIndex::kLength)) {}

    /// A coordinate, as a fraction of 2^32.
    constexpr std::uint32_t bits(std::uint32_t dimension) const noexcept {
        assert(dimension < kDimensions);
        const std::uint32_t seed = static_cast<std::uint32_t>(key_) * kMultipliers[dimension];
        return reversed_bits(scramble_upwards(kSobol.reversed_coordinate(index_, dimension), seed));
    }

    /// A coordinate of 24 bits, in [0, 1).
    constexpr float operator[](std::uint32_t dimension) const noexcept {
        return static_cast<float>(bits(dimension) >> 8) * 0x1p-24f;
    }

    /// A coordinate of 53 bits, in [0, 1), of which the last are random.
    constexpr double fine(std::uint32_t dimension) const noexcept {
        const std::uint64_t last = hash(key_, index_, dimension) >> 43;
        return static_cast<double>(std::uint64_t{bits(dimension)} << 21 | last) * 0x1p-53;
    }

  private:
    /// Odd numbers, which make other seeds of one.
    static constexpr std::uint32_t kMultipliers[kDimensions]{0x9e3779b1u, 0x85ebca77u, 0xc2b2ae3du,
                                                             0x27d4eb2fu};

    std::uint64_t key_;
    std::uint32_t index_;
};

}  // namespace lightcull
