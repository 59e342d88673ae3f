#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "lights/light/importance.h"
#include "lights/light/light_record.h"

namespace lightcull {

/// A sphere in the units of a LightTable.
struct Ball {
    float3 center;
    float radius;
};

/// A light whose chance of acceptance depends on the direction in which the point lies: p_i of
/// [TH16] Eq. 1 with the intensity that goes there, [TH17] Eq. 2. Where p_i is above xi_i, within
/// the light's range R in the direction of its peak, is
/// * for a glossy point the spheroid of [TH17] Eqs. 13 to 15, with the point in one focus;
/// * for a diffuse point the solid of radius R sqrt(cosine);
/// * for all other lights their bounding sphere, grown by R.
class DirectedLight {
  public:
    explicit DirectedLight(const LightRecord& light) noexcept
        : center_(light.center), radius_(light.radius), intensity_(light.intensity) {
        const bool is_diffuse = light.radius == 0.0f && light.two_sided == 0 && light.is_flat();
        if (!is_diffuse && !light.is_glossy()) return;
        kind_ = light.is_glossy() ? Kind::kGlossy : Kind::kDiffuse;
        axis_ = axis_of(light);
        axis_ = axis_ * (1.0f / length(axis_));
        if (light.is_glossy()) sharpness_ = lobe_sharpness(light);
    }

    float3 center() const noexcept { return center_; }
    float radius() const noexcept { return radius_; }  ///< radius of the bounding sphere
    float intensity() const noexcept { return intensity_; }

    /// The distance at which p is in the direction of the peak what it is at a point; infinite
    /// where the light does not shine.
    float distance(const Approach& way) const noexcept {
        if (kind_ == Kind::kSphere) return std::max(way.distance - radius_, 0.0f);
        if (!(way.distance > 0.0f)) return 0.0f;
        if (kind_ == Kind::kGlossy) return way.distance * lobe_fall_off(axis_, sharpness_, way);
        // The cosine grows by the rounding of the axis, as in importance().
        const float cosine = -dot(axis_, way.way) / way.distance + kAxisRounding;
        if (!(cosine > 0.0f)) return std::numeric_limits<float>::infinity();
        return way.distance / std::sqrt(std::min(cosine, 1.0f));
    }

    /// A ball that holds every point whose distance() is at most `range`. About the spheroid it is
    /// the sphere on its longer axis; of the diffuse solid it is the smallest one, whose centre
    /// [TH17] section 6 misprints (design.md, "Glossy lights").
    Ball volume(float range) const noexcept {
        // A margin for the rounding of distance(), which grows with the sharpness of the lobe.
        constexpr float kMargin = 1.0005f;
        // The fourth roots of 1/27 and 4/27.
        constexpr float kDiffuseOffset = 0.43869134f, kDiffuseRadius = 0.62040323f;
        if (kind_ == Kind::kSphere) return {center_, range + radius_};
        if (kind_ == Kind::kDiffuse) {
            return moved(kDiffuseOffset * range, kDiffuseRadius * range * kMargin);
        }
        const float alpha2 = 1.0f / (1.0f + sharpness_);
        return moved(0.5f * (1.0f - alpha2) * range, 0.5f * (1.0f + alpha2) * range * kMargin);
    }

  private:
    enum class Kind { kSphere, kDiffuse, kGlossy };

    Ball moved(float along, float radius) const noexcept {
        // The rounding of the centre's coordinates.
        constexpr float kRounding = 0x1p-22f;
        const float3 c = center_ + axis_ * along;
        return {c, radius + kRounding * (std::abs(c.x) + std::abs(c.y) + std::abs(c.z))};
    }

    float3 center_;
    float radius_, intensity_;
    Kind kind_ = Kind::kSphere;
    float3 axis_{0, 0, 1};
    float sharpness_ = 0.0f;
};

}  // namespace lightcull
