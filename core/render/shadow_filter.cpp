#include "render/shadow_filter.h"

#include "render/embree.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lightcull {
namespace {

/// The part of the way beyond which a lamp does not hide itself. Where its triangles are not much
/// larger than the rounding of the way, rays hit the neighbours of the triangle that they aim at.
constexpr float kBeforeLamp = 1.0f - 0x1p-16f;

V3d largest(const V3f& a, const V3f& b, const V3f& c) noexcept {
    return V3d(std::max({std::fabs(a.x), std::fabs(b.x), std::fabs(c.x)}),
               std::max({std::fabs(a.y), std::fabs(b.y), std::fabs(c.y)}),
               std::max({std::fabs(a.z), std::fabs(b.z), std::fabs(c.z)}));
}

/// Whether the plane of a triangle parts the ends of a ray, in double precision.
bool parts_ends(const V3f& a, const V3f& b, const V3f& c, const Ray& ray) noexcept {
    const V3d corner(a), normal = (V3d(b) - corner).cross(V3d(c) - corner);
    const V3d way = V3d(ray.direction) * static_cast<double>(ray.end);
    const double start = normal.dot(V3d(ray.origin) - corner);
    const double end = start + normal.dot(way);
    // The way is rounded once, and the place that it leads to twice before, by the two sums that
    // make it of a corner and edges.
    constexpr double kUnit = 0x1p-24;
    const V3d rounding = largest(a, b, c) * (2.0 * kUnit) + abs(way) * kUnit;
    return (start > 0.0) != (end > 0.0) && std::fabs(end) > abs(normal).dot(rounding);
}

}  // namespace

bool hides_end(const Triangles& triangles, std::uint32_t triangle, float distance,
               const Ray& ray) noexcept {
    if (triangle == ray.end_triangle) return false;
    if (std::isinf(ray.end)) return true;
    if (ray.end_triangle != kNoHit && distance > ray.end * kBeforeLamp &&
        triangles.records[triangle].mesh == triangles.records[ray.end_triangle].mesh) {
        return false;
    }
    const std::uint32_t* corners = triangles.indices + std::size_t{triangle} * 3;
    return parts_ends(triangles.positions[corners[0]], triangles.positions[corners[1]],
                      triangles.positions[corners[2]], ray);
}

void filter_shadow_hits(const RTCFilterFunctionNArguments* hits) {
    const auto& triangles = *static_cast<const Triangles*>(hits->geometryUserPtr);
    const Ray* const rays = embree::ShadowContext::of(*hits).rays;
    const unsigned count = hits->N;
    for (unsigned i = 0; i < count; ++i) {
        if (hits->valid[i] == 0) continue;
        const Ray& ray = rays[RTCRayN_id(hits->ray, count, i)];
        const float distance = RTCRayN_tfar(hits->ray, count, i) / triangles.distance_unit;
        if (!hides_end(triangles, RTCHitN_primID(hits->hit, count, i), distance, ray)) {
            hits->valid[i] = 0;
        }
    }
}

}  // namespace lightcull
