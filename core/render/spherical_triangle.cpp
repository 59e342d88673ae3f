#include "render/spherical_triangle.h"

#include "render/trigonometry.h"

#include <algorithm>
#include <cmath>

namespace lightcull {
namespace {

V3d unit(const V3d& a) noexcept {
    return a * (1.0 / std::sqrt(a.dot(a)));
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
    : a_(unit(a)), b_(unit(b)), c_(unit(c)), volume_(std::fabs(a_.dot(b_.cross(c_)))) {
    solid_angle_ = 2.0 * arc_tangent(volume_, 1.0 + a_.dot(b_) + b_.dot(c_) + c_.dot(a_));
}

V3d SphericalTriangle::sample(const V2f& u) const noexcept {
    // The part u.x of the area lies between the arc AB and an arc from B to a point D of AC. The
    // tangent of half an area is (Oosterom and Strackee 1983) a ratio of what is linear in the
    // direction of C, and D is the mirror image of A in the direction `middle`.
    const double half = 0.5 * static_cast<double>(u.x) * solid_angle_;
    const auto [sine, cosine] = sine_cosine(0.25 * half).doubled().doubled();
    const V3d middle = a_ * (volume_ * cosine - (a_.dot(c_) + b_.dot(c_)) * sine) +
                       c_ * ((1.0 + a_.dot(b_)) * sine);
    const V3d d = middle * (2.0 * a_.dot(middle) / middle.dot(middle)) - a_;
    const double z = 1.0 - static_cast<double>(u.y) * (1.0 - d.dot(b_));
    const double away = root(1.0 - z * z);
    return away > 0.0 ? b_ * z + across(d, b_) * away : b_;
}

}  // namespace lightcull
