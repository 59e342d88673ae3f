#include "lights/light/frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace lightcull {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();

/// Whether a light counts for where the frame lies.
bool is_placed(const Light& light) noexcept {
    return light.intensity > 0.0f && !light.directional;
}

float largest(float3 a) noexcept {
    return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)});
}

/// The placed light nearest to the caller's origin; null if there is none.
const Light* nearest_to_origin(Span<const Light> lights) noexcept {
    const Light* nearest = nullptr;
    for (const Light& light : lights) {
        if (!is_placed(light)) continue;
        if (nearest == nullptr || largest(light.center) < largest(nearest->center)) {
            nearest = &light;
        }
    }
    return nearest;
}

/// Half the distance from a place to the far side of a light, by its largest coordinate.
float half_distance(const Light& light, float3 from) noexcept {
    const float distance = largest(light.center * 0.5f - from * 0.5f) + light.radius * 0.5f;
    return std::min(distance, kLargest);
}

/// How far lights are from a place: the exponents of their half_distance(), as floats have them.
class Distances {
  public:
    Distances(Span<const Light> lights, float3 from) noexcept {
        for (const Light& light : lights) {
            const float distance = is_placed(light) ? half_distance(light, from) : 0.0f;
            if (distance > 0.0f) {
                is_there_[static_cast<std::size_t>(std::ilogb(distance) - kLeast)] = true;
            }
        }
    }

    /// The half_distance() from which on lights are 2^gap times as far as all nearer ones; infinite
    /// if none are.
    float far_begins(int gap) const noexcept {
        // What lies within a sixteenth of a metre counts as if it reached as far: lamps of no size
        // do not make a room of lamps far.
        constexpr int kLeastNear = -4;
        int last = kLeastNear;
        for (int exponent = kLeast; exponent <= kMost; ++exponent) {
            if (!is_there_[static_cast<std::size_t>(exponent - kLeast)]) continue;
            if (exponent > last + gap) return std::ldexp(1.0f, exponent);
            last = std::max(last, exponent);
        }
        return std::numeric_limits<float>::infinity();
    }

  private:
    static constexpr int kLeast = -150, kMost = 127;
    std::array<bool, kMost - kLeast + 1> is_there_{};
};

struct Bounds {
    float3 low, high;
    float brightest = 0.0f;  ///< intensity

    float3 center() const noexcept { return low * 0.5f + high * 0.5f; }
    float extent() const noexcept { return largest(high * 0.5f - low * 0.5f); }
};

/// The bounds of the placed lights whose half_distance() from a place is below `far`.
Bounds bounds_of_near(Span<const Light> lights, float3 from, float far) noexcept {
    Bounds bounds{from, from};
    for (const Light& light : lights) {
        if (!is_placed(light) || !(half_distance(light, from) < far)) continue;
        const float3 r{light.radius, light.radius, light.radius};
        constexpr float3 kAll{kLargest, kLargest, kLargest};
        bounds.low = min(bounds.low, max(light.center - r, kAll * -1.0f));
        bounds.high = max(bounds.high, min(light.center + r, kAll));
        bounds.brightest = std::max(bounds.brightest, light.intensity);
    }
    return bounds;
}

/// The greatest irradiance of a directional light, W/m^2.
float greatest_irradiance(Span<const Light> lights) noexcept {
    float greatest = 0.0f;
    for (const Light& light : lights) {
        if (light.directional) greatest = std::max(greatest, light.intensity);
    }
    return greatest;
}

/// The frame of the lights that are not directional.
Frame frame_of_placed(Span<const Light> lights) noexcept {
    // Floats are fine enough about an origin in the midst of lights within 2^8 of one another's
    // distances, and their squares hold what is within 2^20.
    constexpr int kOfOrigin = 8, kOfUnit = 20;
    const Light* const first = nearest_to_origin(lights);
    if (first == nullptr) return {};
    const Distances distances(lights, first->center);
    const float far_from_unit = distances.far_begins(kOfUnit);
    const float far_from_origin = distances.far_begins(kOfOrigin);
    const Bounds bounds = bounds_of_near(lights, first->center, far_from_unit);
    const Bounds about_origin = far_from_origin == far_from_unit
                                    ? bounds
                                    : bounds_of_near(lights, first->center, far_from_origin);
    const float extent = bounds.extent();
    // In units of less than this the squared distance of a point that is not near overflows.
    constexpr float kLeastUnit = 1e-12f;
    const float unit = extent > 0.0f ? std::max(extent, kLeastUnit) : 1.0f;
    return {about_origin.center(), 1.0f / unit, bounds.brightest};
}

}  // namespace

double Frame::sun_intensity(float irradiance) const noexcept {
    const double distance =
        static_cast<double>(kSunDistance) / static_cast<double>(inv_scale);  // metres
    return static_cast<double>(irradiance) * distance * distance / static_cast<double>(intensity);
}

Frame make_frame(Span<const Light> lights) noexcept {
    Frame frame = frame_of_placed(lights);
    // Beside a sun that gives more than this times what the brightest of the others gives at one
    // unit, intensities are relative to it: those in a table, and their sums, are floats.
    constexpr double kGreatest = 0x1p19 * double{Frame::kSunDistance} * double{Frame::kSunDistance};
    const double excess = frame.sun_intensity(greatest_irradiance(lights)) / kGreatest;
    if (excess > 1.0) {
        const double intensity = static_cast<double>(frame.intensity) * excess;
        frame.intensity = static_cast<float>(std::min(intensity, double{kLargest}));
    }
    return frame;
}

float reach_in(const Frame& frame, float reach, const Frame& of_reach) noexcept {
    const auto scale =
        static_cast<double>(frame.inv_scale) / static_cast<double>(of_reach.inv_scale);
    const double brightness =
        static_cast<double>(frame.intensity) / static_cast<double>(of_reach.intensity);
    constexpr double kLeast = 1e-30, kGreatest = 1e18;  // the bounds of calibrate_reach()
    return static_cast<float>(
        std::clamp(static_cast<double>(reach) * scale * scale * brightness, kLeast, kGreatest));
}

}  // namespace lightcull
