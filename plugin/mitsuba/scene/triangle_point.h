#pragma once

#include <mitsuba/render/mesh.h>

namespace mitsuba::culling {

/// The barycentric coordinates of a point of the triangle of these corners.
template <typename Point3f>
Point<dr::value_t<Point3f>, 2> barycentric(const Point3f& a, const Point3f& b, const Point3f& c,
                                           const Point3f& p) {
    const auto ab = b - a, ac = c - a, ap = p - a, normal = dr::cross(ab, ac);
    const auto inverse = dr::rcp(dr::squared_norm(normal));
    return {dr::dot(dr::cross(ap, ac), normal) * inverse,
            dr::dot(dr::cross(ab, ap), normal) * inverse};
}

/// The interaction with a triangle of a mesh at prim_uv, as if a ray had hit it there. The caller
/// sets its direction, time and wavelengths.
template <typename Float, typename Spectrum>
SurfaceInteraction<Float, Spectrum> triangle_point(const Mesh<Float, Spectrum>* mesh,
                                                   const dr::uint32_array_t<Float>& triangle,
                                                   const Point<Float, 2>& prim_uv) {
    using SurfaceInteraction3f = SurfaceInteraction<Float, Spectrum>;
    using Shape3f = Shape<Float, Spectrum>;
    auto hit = dr::zeros<PreliminaryIntersection<Float, Shape3f>>(dr::width(triangle));
    hit.t = 0.0f;
    hit.prim_index = triangle;
    hit.prim_uv = prim_uv;
    const auto ray = dr::zeros<Ray<Point<Float, 3>, Spectrum>>(dr::width(triangle));
    SurfaceInteraction3f si = mesh->compute_surface_interaction(ray, hit, +RayFlags::All, 0, true);
    si.finalize_surface_interaction(hit, ray, +RayFlags::All, true);
    return si;
}

}  // namespace mitsuba::culling
