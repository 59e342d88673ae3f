#include "lights/bvh/light_bvh_cluster.h"

#include <algorithm>
#include <cmath>

#include "lights/light/importance.h"

namespace lightcull {
namespace {

constexpr float kPi = 3.14159265f;
/// The least intensity of a cluster that is lit.
constexpr float kLeastIntensity = 1e-37f;

float angle_between(float3 a, float3 b) noexcept {
    return std::atan2(length(cross(a, b)), dot(a, b));
}

/// `axis` turned by `angle` towards `target`, which is not parallel to it.
float3 turned(float3 axis, float3 target, float angle) noexcept {
    const float3 side = target - axis * dot(axis, target);
    const float3 result = axis * std::cos(angle) + side * (std::sin(angle) / length(side));
    return result * (1.0f / length(result));
}

/// True if a cone holds a narrower one about another axis. Sines tell small angles apart, and
/// cosines large ones.
bool holds(const EmissionCone& wide, float3 axis, const EmissionCone& narrow) noexcept {
    const float cos_of_difference =
        wide.cos_theta_o * narrow.cos_theta_o + wide.sin_theta_o * narrow.sin_theta_o;
    const float cosine = dot(wide.axis, axis);
    constexpr float kSmall = 0.9f;
    if (cosine < kSmall || cos_of_difference < kSmall) return cosine >= cos_of_difference;
    const float sin_of_difference =
        wide.sin_theta_o * narrow.cos_theta_o - wide.cos_theta_o * narrow.sin_theta_o;
    const float3 across = cross(wide.axis, axis);
    return dot(across, across) <= sin_of_difference * sin_of_difference;
}

/// The share of a light's emission that follows the cosine to its axis, from all of it for flat
/// lights to none for lights that look the same from everywhere they are seen.
float cosine_share(const EmissionCone& cone) noexcept {
    const float normals = std::max(0.0f, cone.cos_theta_o);
    return normals * normals * (1.0f - std::cos(cone.theta_e));
}

}  // namespace

void EmissionCone::set_theta_o(float angle) noexcept {
    theta_o = angle;
    cos_theta_o = std::cos(angle);
    sin_theta_o = std::sin(angle);
}

float EmissionCone::theta() const noexcept {
    return std::min(theta_o + theta_e, kPi);
}

EmissionCone merge(const EmissionCone& first, const EmissionCone& second) noexcept {
    const bool swap = second.theta_o > first.theta_o;
    const EmissionCone& wide = swap ? second : first;
    const EmissionCone& narrow = swap ? first : second;
    EmissionCone result = wide;
    result.theta_e = std::max(wide.theta_e, narrow.theta_e);
    result.two_sided = wide.two_sided && narrow.two_sided;
    if (wide.two_sided != narrow.two_sided) {
        result.set_theta_o(kPi);
        return result;
    }
    const bool opposed = result.two_sided && dot(wide.axis, narrow.axis) < 0.0f;
    const float3 other = opposed ? -narrow.axis : narrow.axis;
    if (wide.theta_o >= kPi || holds(wide, other, narrow)) return result;

    const float between = angle_between(wide.axis, other);
    const float theta_o = 0.5f * (wide.theta_o + between + narrow.theta_o);
    // Lines, unlike arrows, point everywhere from 90 degrees on.
    const float everywhere = result.two_sided ? 0.5f * kPi : kPi;
    // Between axes that are nearly parallel there is no plane to turn in.
    constexpr float kParallel = 1e-3f;
    if (theta_o >= everywhere || between > kPi - kParallel) {
        result.set_theta_o(kPi);
    } else if (between < kParallel) {
        result.set_theta_o(std::max(wide.theta_o, between + narrow.theta_o));
    } else if (theta_o > wide.theta_o) {
        result.axis = turned(wide.axis, other, theta_o - wide.theta_o);
        result.set_theta_o(theta_o);
    }
    return result;
}

float orientation_measure(const EmissionCone& cone) noexcept {
    const float end = cone.theta();
    const float beyond = end - cone.theta_o;
    const float half_sine = std::sin(0.5f * cone.theta_o);
    // No cosines are subtracted: those of narrow cones do not differ.
    const float tail = 0.5f * (std::sin(end) * std::sin(beyond) + cone.sin_theta_o * beyond);
    const float one_side = 2.0f * kPi * (2.0f * half_sine * half_sine + tail);
    return std::min(cone.two_sided ? 2.0f * one_side : one_side, 4.0f * kPi);
}

namespace {

/// The cone of a light without its axis, and what follows from it alone.
struct ConeShape {
    EmissionCone cone;
    float cosine_share, measure;

    explicit ConeShape(const LightRecord& light) noexcept {
        cone.set_theta_o(2.0f *
                         std::asin(static_cast<float>(light.half_sine_o) * LightRecord::kSnorm));
        // To a cluster a glossy point emits as a point does.
        const float sin_theta_e = static_cast<float>(light.sin_theta_e) * LightRecord::kSnorm;
        cone.theta_e = std::asin(light.is_glossy() ? 1.0f : sin_theta_e);
        cone.two_sided = light.two_sided != 0;
        cosine_share = lightcull::cosine_share(cone);
        measure = orientation_measure(cone);
    }
};

/// A triangle that emits from one side: most lights are as it is.
constexpr LightRecord kOneSided{{0, 0, 0}, 0.0f, 0.0f, {0, 0, 0}, LightRecord::kFlat, 32767, 0};

ConeShape cone_shape(const LightRecord& light) noexcept {
    static const ConeShape one_sided(kOneSided);
    const bool is_one_sided = light.half_sine_o == kOneSided.half_sine_o &&
                              light.sin_theta_e == kOneSided.sin_theta_e && light.two_sided == 0;
    return is_one_sided ? one_sided : ConeShape(light);
}

}  // namespace

LightCluster cluster_of(const LightRecord& light) noexcept {
    const ConeShape shape = cone_shape(light);
    LightCluster result;
    result.flat = light.is_flat();
    const float3 r{light.radius, light.radius, light.radius};
    result.box = {light.center - r, light.center + r};
    EmissionCone& cone = result.cone;
    cone = shape.cone;
    const float3 axis = axis_of(light);
    if (const float norm = length(axis); norm > 0.0f) cone.axis = axis * (1.0f / norm);

    result.intensity = light.intensity;
    if (light.is_glossy()) {
        // To a cluster a lobe is its mean over all directions.
        result.intensity =
            std::max(light.intensity * light.alpha() * light.alpha(), kLeastIntensity);
    }
    result.center = light.center;
    result.radius = light.radius;
    result.variance = kSpread * light.radius * light.radius;
    result.mean_normal = cone.axis * shape.cosine_share;
    result.mean_emission = shape.measure / (4.0f * kPi);
    return result;
}

LightCluster merge(const LightCluster& a, const LightCluster& b) noexcept {
    LightCluster result;
    result.box = a.box;
    result.box.add(b.box);
    result.cone = merge(a.cone, b.cone);
    result.intensity = a.intensity + b.intensity;
    const float share_a = a.intensity / result.intensity;
    const float share_b = b.intensity / result.intensity;

    const float3 way = b.center - a.center;
    result.center = a.center + way * share_b;
    result.variance =
        share_a * a.variance + share_b * b.variance + share_a * share_b * dot(way, way);
    const float3 reach = max(result.box.high - result.center, result.center - result.box.low);
    const float around_children = std::max(length(a.center - result.center) + a.radius,
                                           length(b.center - result.center) + b.radius);
    result.radius = std::min(length(reach), around_children);

    // The sides of two-sided lights cancel unless all lights are two-sided.
    const bool lines = result.cone.two_sided;
    const float weight_a = a.cone.two_sided && !lines ? 0.0f : share_a;
    float weight_b = b.cone.two_sided && !lines ? 0.0f : share_b;
    if (lines && dot(a.mean_normal, b.mean_normal) < 0.0f) weight_b = -weight_b;
    result.mean_normal = a.mean_normal * weight_a + b.mean_normal * weight_b;
    result.mean_emission = share_a * a.mean_emission + share_b * b.mean_emission;
    return result;
}

}  // namespace lightcull
