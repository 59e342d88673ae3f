#pragma once

#include <lightcull/light.h>
#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/float3_math.h"
#include "lights/light/frame.h"

namespace lightcull {

/// The part of a light that every traversal reads, in the units of a LightTable. The same bytes
/// serve all back ends.
struct LightRecord {
    float3 center;
    float radius;
    float intensity;       ///< intensity, in units of Frame::intensity
    std::int16_t axis[3];  ///< axis, in parts of kSnorm
    /// The sine of half of theta_o, in parts of kSnorm, rounded to a wider cone: unlike a cosine it
    /// tells narrow cones apart. kFlat: flat.
    std::int16_t half_sine_o;
    /// The sine of theta_e in parts of kSnorm, rounded to a wider cone; for a glossy point
    /// -lobe_alpha.
    std::int16_t sin_theta_e;
    std::uint16_t two_sided;  ///< 0 or 1

    static constexpr float kSnorm = 1.0f / 32767.0f;
    static constexpr std::int16_t kFlat = 0, kAllNormals = 32767;

    bool is_flat() const noexcept { return half_sine_o == kFlat; }
    bool is_glossy() const noexcept { return sin_theta_e < 0; }
    /// The roughness alpha of a glossy light.
    float alpha() const noexcept { return static_cast<float>(-sin_theta_e) * kSnorm; }
};
static_assert(sizeof(LightRecord) == 32 && alignof(LightRecord) == 4);
static_assert(offsetof(LightRecord, radius) == 12 && offsetof(LightRecord, intensity) == 16);
static_assert(offsetof(LightRecord, axis) == 20 && offsetof(LightRecord, half_sine_o) == 26);
static_assert(offsetof(LightRecord, sin_theta_e) == 28 && offsetof(LightRecord, two_sided) == 30);

/// The mean squared distance of a light, or of several, from the midst of the frame, in its units,
/// where they are far (Frame); 1 where they are not.
inline float far_distance2(float3 center, float variance) noexcept {
    constexpr float kFar = 0x1p16f;
    const float distance2 = dot(center, center) + variance;
    return distance2 > kFar * kFar ? distance2 : 1.0f;
}
inline float far_distance2(const LightRecord& light) noexcept {
    return far_distance2(light.center, 0.0f);
}
inline bool is_far(const LightRecord& light) noexcept {
    return far_distance2(light) > 1.0f;
}
/// The intensity of a light; of a far one, that of a light at one unit which would give as much.
/// The power of a sun is not known.
inline float intensity_nearby(const LightRecord& light) noexcept {
    return light.intensity / far_distance2(light);
}

/// A checked copy of a caller's lights; index i is the caller's index.
struct LightTable {
    Frame frame;
    std::vector<LightRecord> records;
    std::vector<std::uint32_t> lit;  ///< indices of the lights of intensity > 0, ascending
    bool has_glossy = false;         ///< glossy points are among the lit lights
};

/// Throws Error that names the first light and field that is not as Light documents.
LightTable make_light_table(Span<const Light> lights);

/// Makes a table of lights that take the place of `count` others. Throws Error as
/// make_light_table() does, and for another number.
LightTable make_updated_light_table(Span<const Light> lights, std::size_t count);

}  // namespace lightcull
