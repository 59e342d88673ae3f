#include "render/spherical_triangle.h"

#include <algorithm>
#include <cmath>

namespace lightcull {
namespace {

V3d unit(const V3d& a) noexcept {
    return a / std::sqrt(a.dot(a));
}

/// The direction at a right angle to b in the plane of both, on the side of a.
V3d across(const V3d& a, const V3d& b) noexcept {
    return unit(a - b * a.dot(b));
}

double root(double x) noexcept {
    return std::sqrt(std::max(0.0, x));
}

}  // namespace

SphericalTriangle::SphericalTriangle(const V3d& a, const V3d& b, const V3d& c) noexcept
    : a_(unit(a)), b_(unit(b)), c_(unit(c)) {
    const double volume = std::fabs(a_.dot(b_.cross(c_)));
    solid_angle_ = 2.0 * std::atan2(volume, 1.0 + a_.dot(b_) + b_.dot(c_) + c_.dot(a_));
}

V3d SphericalTriangle::sample(const V2f& u) const noexcept {
    const V3d ab = a_.cross(b_), ac = a_.cross(c_);
    const double alpha = std::atan2(std::fabs(a_.dot(ab.cross(ac))), ab.dot(ac));
    const double sin_alpha = std::sin(alpha), cos_alpha = std::cos(alpha);
    // The part u.x of the area lies between the arc AB and an arc from B to a point of AC.
    const double rest = static_cast<double>(u.x) * solid_angle_ - alpha;
    const double s = std::sin(rest), t = std::cos(rest);
    const double p = t - cos_alpha, q = s + sin_alpha * a_.dot(b_);
    const double cos_b = ((q * t - p * s) * cos_alpha - q) / ((q * s + p * t) * sin_alpha);
    const double along = std::isfinite(cos_b) ? std::clamp(cos_b, -1.0, 1.0) : 1.0;
    const V3d c = a_ * along + across(c_, a_) * root(1.0 - along * along);
    const double z = 1.0 - static_cast<double>(u.y) * (1.0 - c.dot(b_));
    const double away = root(1.0 - z * z);
    return away > 0.0 ? b_ * z + across(c, b_) * away : b_;
}

}  // namespace lightcull
