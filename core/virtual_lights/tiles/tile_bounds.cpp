#include "virtual_lights/tiles/tile_bounds.h"

#include <algorithm>
#include <cmath>

namespace lightcull {
namespace {

/// A bound on the rounding of coordinates, relative to them.
constexpr float kRounding = 0x1p-20f;

V3f smaller(const V3f& a, const V3f& b) noexcept {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
V3f larger(const V3f& a, const V3f& b) noexcept {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

/// An interval, and the distance by which a number lies outside it for sure, if the terms of both
/// are at most `magnitude` large.
struct Interval {
    float low, high;

    float gap(float x, float magnitude) const noexcept {
        return std::max(std::max(low - x, x - high) - kRounding * magnitude, 0.0f);
    }
    float magnitude() const noexcept { return std::max(std::fabs(low), std::fabs(high)); }
};

/// The interval of all of factor * [low, high].
Interval scaled(float factor, float low, float high) noexcept {
    const float a = factor * low, b = factor * high;
    return {std::min(a, b), std::max(a, b)};
}

}  // namespace

void FrustumPiece::add(const V3f& point) noexcept {
    const V2f tangent(point.x / point.z, point.y / point.z);
    if (empty) {
        low = high = point;
        tangent_low = tangent_high = tangent;
        empty = false;
        return;
    }
    low = smaller(low, point);
    high = larger(high, point);
    tangent_low = {std::min(tangent_low.x, tangent.x), std::min(tangent_low.y, tangent.y)};
    tangent_high = {std::max(tangent_high.x, tangent.x), std::max(tangent_high.y, tangent.y)};
}

TileBounds::TileBounds(Span<const V3f> points) noexcept {
    if (points.empty()) return;
    const auto [nearest, farthest] = std::minmax_element(
        points.begin(), points.end(), [](const V3f& a, const V3f& b) { return a.z < b.z; });
    split_ = 0.5f * (nearest->z + farthest->z);
    for (const V3f& point : points) pieces_[cluster_of(point)].add(point);
}

AlignedBox box_in_view(const Spheroid& spheroid, const CameraRays& camera) noexcept {
    const V3f center = camera.to_view(spheroid.center - camera.origin());
    const V3f axis = camera.to_view(spheroid.axis);
    // A spheroid reaches as far along a direction as its half axes, seen along it, squared and
    // summed.
    const float across2 = spheroid.radius * spheroid.radius;
    const float along2 = spheroid.half_length * spheroid.half_length;
    V3f reach;
    for (int i = 0; i < 3; ++i) {
        const float part = axis[i] * axis[i];
        reach[i] = std::sqrt(along2 * part + across2 * std::max(0.0f, 1.0f - part));
    }
    reach += V3f(kRounding * (spheroid.half_length + max_component(abs(center))));
    return {center - reach, center + reach};
}

VolumeInView::VolumeInView(const Spheroid& spheroid, const CameraRays& camera) noexcept
    : is_sphere_(spheroid.half_length == spheroid.radius),
      center_(camera.to_view(spheroid.center - camera.origin())),
      radius_(spheroid.half_length) {
    if (is_sphere_) return;
    // The stretch is S = 1 / radius + (1 / half_length - 1 / radius) axis axis^T.
    const V3f axis = camera.to_view(spheroid.axis);
    const float across = 1.0f / spheroid.radius;
    const float along = 1.0f / spheroid.half_length - across;
    const auto stretch = [&](const V3f& v) { return v * across + axis * (along * axis.dot(v)); };
    const V3f x = stretch({1.0f, 0.0f, 0.0f}), y = stretch({0.0f, 1.0f, 0.0f});
    const V3f z = x.cross(y);
    const V3f depth = z.normalized();
    const bool keeps_x = x.dot(x) > y.dot(y);
    const V3f right = keeps_x ? x.normalized() : y.cross(z).normalized();
    const V3f up = keeps_x ? z.cross(x).normalized() : y.normalized();
    // The matrix S is symmetric.
    matrix_ = {stretch(right), stretch(up), stretch(depth)};
    stretched_center_ =
        V3f(matrix_[0].dot(center_), matrix_[1].dot(center_), matrix_[2].dot(center_));
}

bool VolumeInView::overlaps(const FrustumPiece& piece) const noexcept {
    if (piece.empty || !sphere_overlaps(piece)) return false;
    if (is_sphere_) return true;
    float distance2 = 0.0f;
    for (std::size_t i = 0; i < 3; ++i) {
        const V3f& row = matrix_[i];
        const Interval x = scaled(row.x, piece.tangent_low.x, piece.tangent_high.x);
        const Interval y = scaled(row.y, piece.tangent_low.y, piece.tangent_high.y);
        const float low = x.low + y.low + row.z, high = x.high + y.high + row.z;
        const Interval extent{std::min(low * piece.low.z, low * piece.high.z),
                              std::max(high * piece.low.z, high * piece.high.z)};
        const float center = stretched_center_[static_cast<int>(i)];
        const float terms = x.magnitude() + y.magnitude() + std::fabs(row.z);
        const float gap = extent.gap(center, std::max(terms * piece.high.z, std::fabs(center)));
        distance2 += gap * gap;
    }
    return distance2 <= 1.0f;
}

bool VolumeInView::sphere_overlaps(const FrustumPiece& piece) const noexcept {
    const float magnitude = std::max({max_component(abs(piece.low)), max_component(abs(piece.high)),
                                      max_component(abs(center_))});
    const float x = Interval{piece.low.x, piece.high.x}.gap(center_.x, magnitude);
    const float y = Interval{piece.low.y, piece.high.y}.gap(center_.y, magnitude);
    const float z = Interval{piece.low.z, piece.high.z}.gap(center_.z, magnitude);
    return x * x + y * y + z * z <= radius_ * radius_;
}

}  // namespace lightcull
