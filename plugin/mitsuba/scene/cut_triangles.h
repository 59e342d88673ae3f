#pragma once

#include <lightcull/triangle_cuts.h>

#include <mitsuba/render/emitter.h>
#include <mitsuba/render/mesh.h>
#include <mitsuba/render/scene.h>

#include <cstdint>
#include <vector>

namespace mitsuba::culling {

/// A triangle of an emitter that may be cut.
template <typename Float, typename Spectrum>
struct CutCandidate {
    const Emitter<Float, Spectrum>* emitter;
    const Mesh<Float, Spectrum>* mesh;
    std::uint32_t triangle;                ///< index in the mesh
    std::uint32_t light;                   ///< the light that it is, or is a part of
    ::lightcull::TriangleCorners corners;  ///< metres, in the order of the mesh
    ::lightcull::float3 normal;            ///< unit length, on the side that emits
    bool two_sided;
    float radiance;  ///< mean, luminance
};

/// Cuts emissive triangles where they are longer than their distance to what they light, by a few
/// rays in the scene, and where their emission is uneven.
template <typename Float, typename Spectrum>
::lightcull::TriangleCuts cut_triangles(
    const Scene<Float, Spectrum>* scene,
    const std::vector<CutCandidate<Float, Spectrum>>& candidates,
    const ::lightcull::CutLimits& limits);

}  // namespace mitsuba::culling
