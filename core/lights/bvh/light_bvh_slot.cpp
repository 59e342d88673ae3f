#include "lights/bvh/light_bvh_slot.h"

#include <algorithm>
#include <cmath>

#include "lights/light/importance.h"

namespace lightcull {
namespace {

constexpr float kPi = 3.14159265f;

/// Margins by which the bounds of nodes exceed those of their lights, against rounding.
constexpr float kRoundUp = 1.0f + 1e-4f, kLeastRadius = 1e-6f, kAngleMargin = 2e-3f;

/// The least spread and diffuse emission of a slot. With less spread (of the squared radius) or
/// diffuse emission, the importance of a few faint lights among bright ones that face away, or lie
/// below the horizon, would be rounded to 0.
constexpr float kLeastSpread = 1e-4f, kLeastDiffuse = 1e-4f;
/// The least diffuse emission of a flat light, for the rounding of its axis.
constexpr float kLeastFlatDiffuse = 4.0f * kAxisRounding * kAxisRounding;

/// An angle, but wider by what rounding may take from the cosine of a direction to an axis, so that
/// cones narrower than that are not missed.
float widened(float angle) noexcept {
    constexpr float kCosineRounding = 1e-6f;
    const float half_sine = std::sin(0.5f * angle);
    return 2.0f *
           std::asin(std::min(std::sqrt(half_sine * half_sine + 0.5f * kCosineRounding), 1.0f));
}

void set_vector(float (&of)[3][LightBvhNode::kWidth], std::size_t place, float3 value) noexcept {
    of[0][place] = value.x;
    of[1][place] = value.y;
    of[2][place] = value.z;
}

void set_position(MeansNode& node, std::size_t place, const LightCluster& cluster,
                  float radius) noexcept {
    set_vector(node.center, place, cluster.center);
    node.radius[place] = radius;
    // Found by measuring the variance of the estimate: flat between 0.4 and 0.7.
    constexpr float kSpreadOfVariance = 0.55f;
    const float spread =
        std::max(kSpreadOfVariance * cluster.variance, kLeastSpread * radius * radius);
    node.spread[place] = cluster.flat ? -spread : spread;
}

/// The cone of all directions in which the cluster emits, moved back until it holds the cones of
/// all points within `radius`.
void set_cone(MeansNode& node, std::size_t place, const EmissionCone& cone, float radius,
              float margin) noexcept {
    constexpr float kAllDirections = 3.13f;
    set_vector(node.axis, place, cone.axis);
    const float theta = widened(std::min(cone.theta() + margin, kPi));
    if (theta > kAllDirections) {
        node.apex[place] = 0.0f;
        node.cosine[place] = -2.0f;
    } else {
        const float cosine = std::cos(theta);
        node.apex[place] = radius / std::sin(theta);
        node.cosine[place] = cosine * std::abs(cosine);
    }
}

/// The share of all directions that lie in the cone.
float solid_angle_share(const EmissionCone& cone) noexcept {
    const float sine = std::sin(0.5f * cone.theta());
    return cone.two_sided ? std::min(1.0f, 2.0f * sine * sine) : sine * sine;
}

/// The value of MeansNode::diffuse. The mean that a cluster emits over its cone, twice, is 1 for
/// flat lights; the more the normals differ, the less depends on direction.
float diffuse(const LightCluster& cluster) noexcept {
    const float inside =
        2.0f * std::min(1.0f, cluster.mean_emission / solid_angle_share(cluster.cone));
    const float spread_of_normals =
        1.0f - std::min(1.0f, dot(cluster.mean_normal, cluster.mean_normal));
    return inside * inside * spread_of_normals;
}

void set_emission(MeansNode& node, std::size_t place, const LightCluster& cluster) noexcept {
    node.intensity[place] = cluster.intensity;
    set_vector(node.mean_normal, place, cluster.mean_normal);
    const float least = cluster.flat ? kLeastFlatDiffuse : kLeastDiffuse;
    node.diffuse[place] =
        std::copysign(std::max(diffuse(cluster), least), cluster.cone.two_sided ? -1.0f : 1.0f);
}

}  // namespace

void fill_slot(BoundsNode& node, std::size_t place, const LightCluster& cluster,
               SlotKind kind) noexcept {
    const bool is_node = kind == SlotKind::kNode;
    if (is_node) {
        const Box& box = cluster.box;
        set_vector(node.center, place, (box.low + box.high) * 0.5f);
        node.radius[place] = 0.5f * length(box.high - box.low) * kRoundUp + kLeastRadius;
    } else {
        set_vector(node.center, place, cluster.center);
        node.radius[place] = cluster.radius;
    }
    node.intensity[place] = cluster.intensity;
    const EmissionCone& cone = cluster.cone;
    const float margin = is_node ? kAngleMargin : kAxisRounding;
    const float theta = std::min(cone.theta() + margin, kPi);
    const float theta_o = std::min(kPi, cone.theta_o + margin + (widened(theta) - theta));
    set_vector(node.axis, place, cone.axis);
    node.cos_theta_o[place] = std::cos(theta_o);
    node.sin_theta_o[place] = std::max(0.0f, std::sin(theta_o));
    const float cos_theta_e = std::max(0.0f, std::cos(cone.theta_e));
    node.cos_theta_e[place] = std::copysign(cos_theta_e, cone.two_sided ? -1.0f : 1.0f);
}

void fill_slot(MeansNode& node, std::size_t place, const LightCluster& cluster,
               SlotKind kind) noexcept {
    const bool is_node = kind == SlotKind::kNode;
    const float radius = is_node ? cluster.radius * kRoundUp + kLeastRadius : cluster.radius;
    set_position(node, place, cluster, radius);
    // One plane bounds what a flat light reaches; near the light, the bound is by what its axis may
    // be off.
    const float thickness = std::sqrt(kSpread) * kAxisRounding * radius;
    set_cone(node, place, cluster.cone, cluster.flat ? thickness : radius,
             is_node ? kAngleMargin : kAxisRounding);
    set_emission(node, place, cluster);
}

void clear_slot(BoundsNode& node, std::size_t place) noexcept {
    node.child[place] = LightBvhNode::kEmpty;
}

void clear_slot(MeansNode& node, std::size_t place) noexcept {
    node.spread[place] = 1.0f;
    node.child[place] = LightBvhNode::kEmpty;
}

}  // namespace lightcull
