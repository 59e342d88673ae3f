#pragma once

#include <lightcull/light.h>
#include <lightcull/span.h>

#include "base/float3_math.h"

namespace lightcull {

/// A transform from the caller's metres to the units of a table, in which the bounds of all lights
/// but far ones lie in about [-2, 2]: no digits are lost to a far origin or to a sun, and no power
/// of a length overflows.
struct Frame {
    float3 origin{0, 0, 0};  ///< origin of the table's units, metres
    float inv_scale = 1.0f;  ///< 1 / metres
    float intensity = 1.0f;  ///< intensity of the brightest light that is not far, W/sr, or what
                             ///< directional lights ask for, if that is more

    float3 position(float3 x) const noexcept { return (x - origin) * inv_scale; }

    /// The distance at which a directional light stands in the table, in its units: to points
    /// within 2^16 units of the lights its direction is the same to the last digit of a float.
    static constexpr float kSunDistance = 0x1p40f;
    /// The intensity, in units of `intensity`, that gives so much irradiance (W/m^2) from there.
    double sun_intensity(float irradiance) const noexcept;
};

/// The frame of lights, of which those of intensity 0 do not count, and directional ones to
/// `intensity` alone. Its origin is in the midst of
/// those about the light that is nearest to the caller's origin, where the caller's own numbers are
/// the finest. Far are lights whose distance from there is a million times that of all nearer ones.
Frame make_frame(Span<const Light> lights) noexcept;

/// The `reach` (RandomRanges) of one frame in the units of another: ranges stay as long in metres.
float reach_in(const Frame& frame, float reach, const Frame& of_reach) noexcept;

}  // namespace lightcull
