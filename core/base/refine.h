#pragma once

#include <lightcull/light_sampler.h>

#include <cstdint>
#include <cstring>

#include "base/random.h"

namespace lightcull {

/// The bits of a float as a number.
inline std::uint32_t float_bits(float value) noexcept {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}

/// The number u with more digits, in [0, 1). A float has 24 bits, too few to tell a million lights
/// apart evenly; the missing ones come from a hash of u and the point.
inline double refine(float u, const ShadingPoint& point) noexcept {
    const std::uint64_t xy =
        (std::uint64_t{float_bits(point.position.x)} << 32) | float_bits(point.position.y);
    const std::uint64_t zu = (std::uint64_t{float_bits(point.position.z)} << 32) | float_bits(u);
    const double refined =
        static_cast<double>(u) + static_cast<double>(uniform_float(hash(xy, zu))) * 0x1p-24;
    return refined < 1.0 ? refined : 1.0 - 0x1p-53;
}

}  // namespace lightcull
