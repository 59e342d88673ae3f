#include "lights/light/light_record.h"

#include "base/parallel_blocks.h"

#include <lightcull/error.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace lightcull {
namespace {

constexpr float kLeastLobeAlpha = 1e-3f;

[[noreturn]] void fail(std::size_t light, const char* field, const std::string& what) {
    throw Error("light " + std::to_string(light) + ": " + field + " " + what);
}

void check_range(std::size_t light, const char* field, float value, float low, float high) {
    if (!(value >= low && value <= high)) {
        fail(light, field,
             "is " + std::to_string(value) + ", wanted " + std::to_string(low) + " to " +
                 std::to_string(high));
    }
}

void check_glossy(std::size_t i, const Light& light) {
    check_range(i, "lobe_alpha", light.lobe_alpha, kLeastLobeAlpha, 1.0f);
    check_range(i, "radius of a glossy point", light.radius, 0.0f, 0.0f);
    check_range(i, "cos_theta_o of a glossy point", light.cos_theta_o, -1.0f, -1.0f);
    if (light.two_sided) fail(i, "two_sided", "is set, and it is a glossy point");
}

void check_directional(std::size_t i, const Light& light) {
    check_range(i, "radius of a directional light", light.radius, 0.0f, 0.0f);
    check_range(i, "cos_theta_o of a directional light", light.cos_theta_o, -1.0f, -1.0f);
    check_range(i, "lobe_alpha of a directional light", light.lobe_alpha, 0.0f, 0.0f);
    if (light.two_sided) fail(i, "two_sided", "is set, and it is a directional light");
}

void check(std::size_t i, const Light& light) {
    constexpr float kMaxIntensity = 3e38f;
    constexpr float kAxisTolerance = 1e-3f;
    if (!is_finite(light.center)) fail(i, "center", "is not finite");
    if (!std::isfinite(light.radius) || light.radius < 0.0f) {
        fail(i, "radius", "is " + std::to_string(light.radius) + ", wanted finite and >= 0");
    }
    if (!(light.intensity >= 0.0f && light.intensity <= kMaxIntensity)) {
        fail(i, "intensity", "is " + std::to_string(light.intensity) + ", wanted finite and >= 0");
    }
    check_range(i, "cos_theta_o", light.cos_theta_o, -1.0f, 1.0f);
    check_range(i, "cos_theta_e", light.cos_theta_e, 0.0f, 1.0f);
    if (light.directional) {
        check_directional(i, light);
    } else if (light.lobe_alpha != 0.0f) {
        check_glossy(i, light);
    }
    const bool needs_axis =
        light.cos_theta_o > -1.0f || light.lobe_alpha != 0.0f || light.directional;
    if (needs_axis && !(std::abs(length(light.axis) - 1.0f) < kAxisTolerance)) {
        fail(i, "axis", "has length " + std::to_string(length(light.axis)) + ", wanted 1");
    }
}

std::int16_t to_snorm(float value) noexcept {
    return static_cast<std::int16_t>(std::lround(std::clamp(value, -1.0f, 1.0f) * 32767.0f));
}

constexpr double kPi = 3.14159265358979323846;

/// The largest angle whose cosine may have been rounded to this one.
double widest_angle(float cosine) noexcept {
    constexpr double kHalfUlp = 0x1p-25;  // of floats just below 1
    return std::acos(std::max(-1.0, static_cast<double>(cosine) - kHalfUlp));
}

/// A sine rounded up, so that a cone can only grow.
std::int16_t to_wider_sine(double sine) noexcept {
    return static_cast<std::int16_t>(std::min(std::ceil(sine * 32767.0), 32767.0));
}

std::int16_t half_sine_o(const Light& light) noexcept {
    // The margin covers the rounding of the axis, which is below 3e-5 radians.
    constexpr double kAxisMargin = 5e-5;
    if (light.cos_theta_o == 1.0f) return LightRecord::kFlat;
    const double theta_o = std::min(widest_angle(light.cos_theta_o) + kAxisMargin, kPi);
    return to_wider_sine(std::sin(0.5 * theta_o));
}

std::int16_t sin_theta_e(const Light& light) noexcept {
    if (light.lobe_alpha > 0.0f) return to_snorm(-light.lobe_alpha);
    return to_wider_sine(std::sin(std::min(widest_angle(light.cos_theta_e), 0.5 * kPi)));
}

LightRecord to_record(const Light& light, const Frame& frame) noexcept {
    LightRecord record{};
    record.radius = light.radius * frame.inv_scale;
    // A far sun may be brighter than all lamps by more than floats hold.
    constexpr float kMost = 1e30f;
    if (light.directional) {
        // A sun is a point that is far away, to all that weighs lights.
        record.center = light.axis * (-Frame::kSunDistance / length(light.axis));
        record.intensity =
            static_cast<float>(std::min(frame.sun_intensity(light.intensity), double{kMost}));
    } else {
        record.center = frame.position(light.center);
        record.intensity = std::min(light.intensity / frame.intensity, kMost);
    }
    record.two_sided = light.two_sided ? 1 : 0;
    if (light.cos_theta_o > -1.0f || light.lobe_alpha > 0.0f) {
        const float3 axis = light.axis * (1.0f / length(light.axis));
        record.axis[0] = to_snorm(axis.x);
        record.axis[1] = to_snorm(axis.y);
        record.axis[2] = to_snorm(axis.z);
    }
    record.half_sine_o = half_sine_o(light);
    record.sin_theta_e = sin_theta_e(light);
    return record;
}

}  // namespace

LightTable make_light_table(Span<const Light> lights) {
    constexpr std::size_t kMaxLights = std::size_t{1} << 30;
    if (lights.size() > kMaxLights) {
        throw Error("too many lights: " + std::to_string(lights.size()) + ", at most " +
                    std::to_string(kMaxLights));
    }
    for (std::size_t i = 0; i < lights.size(); ++i) check(i, lights[i]);

    LightTable table;
    table.frame = make_frame(lights);
    table.records.resize(lights.size());
    constexpr std::size_t kBlock = 4096;
    for_each_block(lights.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            table.records[i] = to_record(lights[i], table.frame);
        }
    });
    for (std::size_t i = 0; i < lights.size(); ++i) {
        // Relative to the brightest light, the faintest may vanish; then no path would ever miss
        // it.
        if (table.records[i].intensity > 0.0f) {
            table.lit.push_back(static_cast<std::uint32_t>(i));
            table.has_glossy |= table.records[i].is_glossy();
        }
    }
    return table;
}

LightTable make_updated_light_table(Span<const Light> lights, std::size_t count) {
    if (lights.size() != count) {
        throw Error("update: there are " + std::to_string(lights.size()) +
                    " lights, and the sampler was made over " + std::to_string(count));
    }
    return make_light_table(lights);
}

}  // namespace lightcull
