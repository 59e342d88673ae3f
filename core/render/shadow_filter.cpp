#include "render/shadow_filter.h"

#include "render/cut_outs.h"
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

struct Corners {
    const V3f &a, &b, &c;
};
Corners corners_of(const Triangles& triangles, std::uint32_t triangle) noexcept {
    const std::uint32_t* const corners = triangles.indices + std::size_t{triangle} * 3;
    return {triangles.positions[corners[0]], triangles.positions[corners[1]],
            triangles.positions[corners[2]]};
}

/// By how much rounding has moved the end of a ray. The way is rounded once, and a place on a
/// triangle twice before, by the two sums that make it of a corner and edges.
V3d rounding_of_end(const Triangles& triangles, const Ray& ray, const V3d& way) noexcept {
    constexpr double kUnit = 0x1p-24;
    V3d place = abs(V3d(ray.origin) + way);
    if (ray.end_triangle != kNoHit) {
        const Corners end = corners_of(triangles, ray.end_triangle);
        place = largest(end.a, end.b, end.c);
    }
    return place * (2.0 * kUnit) + abs(way) * kUnit;
}

/// Whether the plane of a triangle parts the ends of a ray, in double precision.
bool parts_ends(const Triangles& triangles, std::uint32_t triangle, const Ray& ray) noexcept {
    const auto [a, b, c] = corners_of(triangles, triangle);
    const V3d corner(a), normal = (V3d(b) - corner).cross(V3d(c) - corner);
    const V3d way = V3d(ray.direction) * static_cast<double>(ray.end);
    const double start = normal.dot(V3d(ray.origin) - corner);
    const double end = start + normal.dot(way);
    const V3d rounding = rounding_of_end(triangles, ray, way);
    return (start > 0.0) != (end > 0.0) && std::fabs(end) > abs(normal).dot(rounding);
}

Hit hit_of(const RTCFilterFunctionNArguments& hits, unsigned i) noexcept {
    return {RTCHitN_primID(hits.hit, hits.N, i), RTCHitN_u(hits.hit, hits.N, i),
            RTCHitN_v(hits.hit, hits.N, i)};
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
    return parts_ends(triangles, triangle, ray);
}

void filter_cut_outs(const RTCFilterFunctionNArguments* hits) {
    const auto& triangles = *static_cast<const Triangles*>(hits->geometryUserPtr);
    const unsigned count = hits->N;
    for (unsigned i = 0; i < count; ++i) {
        if (hits->valid[i] == 0) continue;
        const V3f origin(RTCRayN_org_x(hits->ray, count, i), RTCRayN_org_y(hits->ray, count, i),
                         RTCRayN_org_z(hits->ray, count, i));
        const V3f direction(RTCRayN_dir_x(hits->ray, count, i), RTCRayN_dir_y(hits->ray, count, i),
                            RTCRayN_dir_z(hits->ray, count, i));
        if (!meets(*triangles.cut_outs, hit_of(*hits, i), origin, direction)) hits->valid[i] = 0;
    }
}

void filter_shadow_hits(const RTCFilterFunctionNArguments* hits) {
    const auto& triangles = *static_cast<const Triangles*>(hits->geometryUserPtr);
    const Ray* const rays = embree::ShadowContext::of(*hits).rays;
    const unsigned count = hits->N;
    for (unsigned i = 0; i < count; ++i) {
        if (hits->valid[i] == 0) continue;
        const Ray& ray = rays[RTCRayN_id(hits->ray, count, i)];
        const float distance = RTCRayN_tfar(hits->ray, count, i) / triangles.distance_unit;
        const Hit hit = hit_of(*hits, i);
        if (!hides_end(triangles, hit.triangle, distance, ray) ||
            (triangles.cut_outs != nullptr &&
             !meets(*triangles.cut_outs, hit, ray.origin, ray.direction))) {
            hits->valid[i] = 0;
        }
    }
}

}  // namespace lightcull
