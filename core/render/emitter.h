#pragma once

#include "base/core_export.h"
#include "render/vec.h"

#include <lightcull/light.h>
#include <lightcull/render/scene.h>

#include <cstdint>
#include <variant>

namespace lightcull {

/// What light sampling needs of an emissive triangle, in one place: it is read at random.
struct TriangleEmitter {
    V3f corner, edge1, edge2;  ///< the first corner, and from it to the second and third
    V3f radiance;              ///< texture aside
    std::uint32_t triangle;    ///< index over all meshes
    TextureId texture;
    bool two_sided;
};

struct PointEmitter {
    V3f position, intensity;
};

/// Full intensity up to the inner angle, then down to 0 at the outer one as the square of a ramp
/// in the cosine (glTF's KHR_lights_punctual).
struct SpotEmitter {
    V3f position, intensity;
    V3f direction;  ///< unit length
    float cos_inner, cos_outer;
};

/// One of SceneData::virtual_lights, which are larger than other emitters.
struct VirtualEmitter {
    std::uint32_t index;
};

using Emitter = std::variant<TriangleEmitter, PointEmitter, SpotEmitter, VirtualEmitter>;

/// A place on an emitter, seen from a surface.
struct EmitterSample {
    V3f place{0.0f};      ///< what a shadow ray must reach
    V3f direction{0.0f};  ///< towards it, unit length
    V3f radiance{0.0f};   ///< of all but triangles what falls on a surface that faces them
    float pdf = 0.0f;     ///< per solid angle; 1 for all but triangles, 0 if it emits nothing here
    bool is_delta = false;
};

/// Chooses a place on the emitter, uniform by area, and looks at it from a point.
EmitterSample sample_emitter(const SceneData& scene, const Emitter& emitter, const V3f& from,
                             const V2f& u) noexcept;

/// The part of its intensity that a spot emits at `cosine` from its direction.
LIGHTCULL_CORE_EXPORT float spot_falloff(const SpotEmitter& emitter, float cosine) noexcept;

/// Density per solid angle, seen from a point, of a place on the triangle that sample_emitter()
/// would have chosen: `to_place` leads from the point to it. 0 in the triangle's plane.
float triangle_pdf(const TriangleEmitter& emitter, const V3f& to_place) noexcept;

/// What the triangle emits at (u, v) into `direction`, which leaves it.
LIGHTCULL_CORE_EXPORT V3f emitted(const SceneData& scene, const TriangleEmitter& emitter, float u,
                                  float v, const V3f& direction) noexcept;

}  // namespace lightcull
