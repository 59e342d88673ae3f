#pragma once

#include <lightcull/float3.h>

#include "base/float3_math.h"
#include "lights/light/light_record.h"

namespace lightcull {

/// Directions of emission, as Light has them: normals up to theta_o from the axis, emission up to
/// theta_e from a normal. Where two_sided is set, a second cone about -axis emits alike.
struct EmissionCone {
    float3 axis{0, 0, 1};
    float theta_o = 0.0f, theta_e = 0.0f;
    float cos_theta_o = 1.0f, sin_theta_o = 0.0f;
    bool two_sided = false;

    void set_theta_o(float angle) noexcept;
    /// The half-angle of all emission, at most pi.
    float theta() const noexcept;
};

/// The smallest cone around both, as Conty Estevez & Kulla 2018 find it. One- and
/// two-sided lights together count as emitting everywhere.
EmissionCone merge(const EmissionCone& a, const EmissionCone& b) noexcept;

/// The measure M_Omega of the same paper: the integral over all directions of the emission of a
/// light of this cone, relative to its peak. In (0, 4 pi].
float orientation_measure(const EmissionCone& cone) noexcept;

struct Box {
    float3 low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};

    void add(const Box& other) noexcept {
        low = min(low, other.low);
        high = max(high, other.high);
    }
};

/// Bounds and means of a set of lights.
struct LightCluster {
    bool flat = false;  ///< one light, all of it in the plane through center across the cone's axis
    Box box;
    EmissionCone cone;
    float intensity = 0.0f;       ///< sum of the lights' intensities
    float3 center{0, 0, 0};       ///< mean position, like all means weighted by intensity
    float radius = 0.0f;          ///< radius of a sphere around center that holds all lights
    float variance = 0.0f;        ///< mean squared distance from center
    float3 mean_normal{0, 0, 0};  ///< mean normal of what is emitted in proportion to the cosine to
                                  ///< a normal; up to signs where the cone is two-sided
    float mean_emission = 0.0f;   ///< mean emission over all directions, relative to intensity
};

LightCluster cluster_of(const LightRecord& light) noexcept;
LightCluster merge(const LightCluster& a, const LightCluster& b) noexcept;

}  // namespace lightcull
