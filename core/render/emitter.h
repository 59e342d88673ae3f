#pragma once

#include "base/core_export.h"
#include "render/ray.h"
#include "render/triangle_record.h"
#include "render/vec.h"

#include <lightcull/light.h>
#include <lightcull/render/scene.h>
#include <lightcull/triangle_cuts.h>

#include <cmath>
#include <cstdint>
#include <variant>

namespace lightcull {

/// The data of an emissive triangle, or a part of one, that light sampling needs, in one place: it
/// is read at random.
struct TriangleEmitter {
    V3f corner, edge1, edge2;  ///< first corner, and the edges from it to the second and third: of
                               ///< the part, but of the whole triangle where that has a texture
    V3f radiance;              ///< radiance, texture aside
    std::uint32_t triangle;    ///< index of the triangle over all meshes
    std::uint32_t part;        ///< index into SceneData::cuts; kNone: a whole triangle, even enough
    bool two_sided;
    bool has_texture = false;
};

struct PointEmitter {
    V3f position, intensity;
};

/// A spot of full intensity up to the inner angle, then down to 0 at the outer one as the square of
/// a ramp in the cosine (glTF's KHR_lights_punctual). Angles t are known by their versines
/// 1 - cos t, which tell small ones apart where cosines, all near 1, do not.
struct SpotEmitter {
    V3f position, intensity;
    V3f direction;       ///< direction of the spot, unit length
    float inner, outer;  ///< versines of the angles
};

inline float versine(float angle) noexcept {
    const double sine = std::sin(0.5 * static_cast<double>(angle));
    return static_cast<float>(2.0 * sine * sine);
}

/// The versine of the angle between two vectors of unit length.
inline float versine(const V3f& a, const V3f& b) noexcept {
    const V3f between = a - b;
    return 0.5f * between.dot(between);
}

/// A sun: parallel light from infinity.
struct DirectionalEmitter {
    V3f direction;   ///< direction in which it goes, unit length
    V3f irradiance;  ///< irradiance on a surface that faces it
};

/// An element of SceneData::virtual_lights, which are larger than other emitters.
struct VirtualEmitter {
    std::uint32_t index;
};

using Emitter =
    std::variant<TriangleEmitter, PointEmitter, SpotEmitter, DirectionalEmitter, VirtualEmitter>;

/// A place on an emitter, seen from a surface.
struct EmitterSample {
    V3f place{0.0f};      ///< place on the emitter, where a shadow ray ends; at infinity it is 0
    V3f direction{0.0f};  ///< direction towards the place, unit length
    V3f radiance{0.0f};   ///< radiance; for all but triangles, irradiance on a surface that faces
                          ///< the emitter
    float pdf = 0.0f;     ///< density per solid angle; 1 for all but triangles, 0 if the emitter
                          ///< emits nothing here
    bool is_delta = false;
    std::uint32_t triangle = kNoHit;  ///< the triangle on which the place lies, if any
    bool at_infinity = false;         ///< the emitter is infinitely far

    /// The ray from a point to the place.
    Ray shadow_ray(const V3f& from) const noexcept {
        return at_infinity ? Ray{from, direction} : segment(from, place, triangle);
    }
};

/// Random numbers in [0, 1) by which a place on an emitter is chosen.
struct PlaceNumbers {
    double piece;  ///< chooses among tens of thousands of pieces, where there are some
    V2f place;
};

/// Chooses a place on the emitter and looks at it from a point. On a triangle it is uniform by
/// solid angle where the point is near it, else by area.
EmitterSample sample_emitter(const SceneData& scene, const Emitter& emitter, const V3f& from,
                             const PlaceNumbers& u) noexcept;

/// The part of its intensity that a spot emits at an angle to its direction, of which this is the
/// versine.
LIGHTCULL_CORE_EXPORT float spot_falloff(const SpotEmitter& emitter, float versine) noexcept;

/// Density per solid angle, seen from a point, of a place on the triangle that sample_emitter()
/// would have chosen if the triangle is even: `to_place` leads from the point to it. 0 in the
/// triangle's plane.
LIGHTCULL_CORE_EXPORT float triangle_pdf(const TriangleEmitter& emitter, const V3f& from,
                                         const V3f& to_place) noexcept;

/// True if places on the emitter are chosen piece by piece, its texture being uneven.
inline bool has_pieces(const TriangleEmitter& emitter) noexcept {
    return emitter.has_texture && emitter.part != kNone;
}

/// The light that a place of an emissive triangle belongs to, and the density per solid angle with
/// which sample_emitter() of it would have chosen the place. 0: it would not have.
struct PlacePdf {
    std::uint32_t light;
    float pdf;
};

/// As triangle_pdf(), of the triangle that has `light`, and maybe others, at barycentric
/// coordinates.
LIGHTCULL_CORE_EXPORT PlacePdf place_pdf(const SceneData& scene, std::uint32_t light, float2 place,
                                         const V3f& from, const V3f& to_place) noexcept;

/// The part of a triangle that lies in its sub-triangle; `whole` has all of the triangle's edges.
LIGHTCULL_CORE_EXPORT TriangleEmitter part_of(const TriangleEmitter& whole,
                                              const SubTriangle& part) noexcept;

/// The radiance that the triangle emits at (u, v) into `direction`, which leaves it, to a ray that
/// meets it there.
LIGHTCULL_CORE_EXPORT V3f emitted(const SceneData& scene, const TriangleEmitter& emitter, float u,
                                  float v, const V3f& direction) noexcept;

/// The same to a ray that was sent to the place, and may go through where the triangle is cut out.
LIGHTCULL_CORE_EXPORT V3f emitted_on_average(const SceneData& scene, const TriangleEmitter& emitter,
                                             float u, float v, const V3f& direction) noexcept;

}  // namespace lightcull
