#pragma once

#include "base/random.h"
#include "render/vec.h"

#include <cstdint>

namespace lightcull {

/// The use of a random number of a path vertex.
enum class Dimension : std::uint64_t {
    kSelectLight,  ///< choice of a light
    kLightVertex,  ///< place on the light
    kEnvironment,  ///< cell of the environment
    kInCell,       ///< direction within it
    kLobe,         ///< choice between diffuse and specular
    kScatter,      ///< direction of the next ray
    kRoulette,
    kLightPiece,  ///< piece of a light whose emission is uneven
};

/// The random numbers of one vertex of a path, independent of all others: a hash of what they are
/// for. PixelNumbers are for paths of which each pixel has many.
class PathRandom {
  public:
    PathRandom(std::uint64_t key, std::uint32_t path, std::uint32_t depth) noexcept
        : key_(hash(key, path, depth)) {}

    /// A number in [0, 1).
    float one(Dimension d) const noexcept { return uniform_float(bits(d)); }
    /// Two independent numbers in [0, 1).
    V2f two(Dimension d) const noexcept {
        const std::uint64_t b = bits(d);
        return {uniform_float(b), uniform_float(b << 24)};
    }
    /// A number in [0, 1) of 53 bits, for choices among millions.
    double fine(Dimension d) const noexcept { return static_cast<double>(bits(d) >> 11) * 0x1p-53; }

  private:
    std::uint64_t bits(Dimension d) const noexcept {
        return hash(key_, static_cast<std::uint64_t>(d));
    }

    std::uint64_t key_;
};

}  // namespace lightcull
