#include "render/shadow_filter.h"

#include "render/cut_outs.h"
#include "render/embree.h"
#include "render/facet.h"
#include "render/scene_data.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lightcull {
namespace {

/// The part of the way beyond which a lamp does not hide itself. Where its triangles are not much
/// larger than the rounding of the way, rays hit the neighbours of the triangle that they aim at.
constexpr float kBeforeLamp = 1.0f - 0x1p-16f;

/// By how much rounding has moved the end of a ray. The way is rounded once, and a place on a
/// triangle twice before, by the two sums that make it of a corner and edges.
V3d rounding_of_end(const SceneData& scene, const Ray& ray, const V3d& way) noexcept {
    constexpr double kUnit = 0x1p-24;
    V3d place = abs(V3d(ray.origin) + way);
    if (ray.end_triangle != kNoHit) {
        place = V3d(Facet(scene, ray.end_triangle, kNotInstanced).magnitude);
    }
    return place * (2.0 * kUnit) + abs(way) * kUnit;
}

/// Whether the plane of a triangle parts the ends of a ray, in double precision.
bool parts_ends(const SceneData& scene, const Hit& hit, const Ray& ray) noexcept {
    const Facet facet(scene, hit.triangle, hit.instance);
    const V3d corner(facet.a), normal = (V3d(facet.b) - corner).cross(V3d(facet.c) - corner);
    const V3d way = V3d(ray.direction) * static_cast<double>(ray.end);
    const double start = normal.dot(V3d(ray.origin) - corner);
    const double end = start + normal.dot(way);
    const V3d rounding = rounding_of_end(scene, ray, way);
    return (start > 0.0) != (end > 0.0) && std::fabs(end) > abs(normal).dot(rounding);
}

Hit hit_of(const Triangles& triangles, const RTCFilterFunctionNArguments& hits,
           unsigned i) noexcept {
    const unsigned placed = RTCHitN_instID(hits.hit, hits.N, i, 0);
    return {triangles.first + RTCHitN_primID(hits.hit, hits.N, i), RTCHitN_u(hits.hit, hits.N, i),
            RTCHitN_v(hits.hit, hits.N, i),
            placed == RTC_INVALID_GEOMETRY_ID ? kNotInstanced : placed - triangles.first_instance};
}

}  // namespace

bool hides_end(const SceneData& scene, const Hit& hit, float distance, const Ray& ray) noexcept {
    if (hit.triangle == ray.end_triangle) return false;
    if (std::isinf(ray.end)) return true;
    if (ray.end_triangle != kNoHit && distance > ray.end * kBeforeLamp &&
        scene.triangles[hit.triangle].mesh == scene.triangles[ray.end_triangle].mesh) {
        return false;
    }
    return parts_ends(scene, hit, ray);
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
        if (!meets(*triangles.scene, hit_of(triangles, *hits, i), origin, direction))
            hits->valid[i] = 0;
    }
}

void filter_shadow_hits(const RTCFilterFunctionNArguments* hits) {
    const auto& triangles = *static_cast<const Triangles*>(hits->geometryUserPtr);
    const SceneData& scene = *triangles.scene;
    const Ray* const rays = embree::ShadowContext::of(*hits).rays;
    const unsigned count = hits->N;
    for (unsigned i = 0; i < count; ++i) {
        if (hits->valid[i] == 0) continue;
        const Ray& ray = rays[RTCRayN_id(hits->ray, count, i)];
        const float distance = RTCRayN_tfar(hits->ray, count, i) / triangles.distance_unit;
        const Hit hit = hit_of(triangles, *hits, i);
        if (!hides_end(scene, hit, distance, ray) ||
            (scene.has_cut_outs && !meets(scene, hit, ray.origin, ray.direction))) {
            hits->valid[i] = 0;
        }
    }
}

}  // namespace lightcull
