#pragma once

#include "base/core_export.h"
#include "render/bsdf.h"
#include "render/ray.h"
#include "render/vec.h"

#include <lightcull/light_sampler.h>
#include <lightcull/render/scene.h>

namespace lightcull {

/// A point of a surface, seen from one side.
struct Surface {
    V3f position{0.0f};
    V3f normal{0.0f};  ///< geometric normal, on the viewer's side
    V3f origin{0.0f};  ///< start of rays that leave on the viewer's side
    Bsdf bsdf;

    /// The point that a light sampler is asked about: it has the shading normal, on the viewer's
    /// side.
    ShadingPoint shading_point(std::uint32_t set) const noexcept {
        return {to_float3(position), to_float3(bsdf.normal()), set, bsdf.diffuse_part(),
                bsdf.glossy_part()};
    }
};

V3f hit_position(const SceneData& scene, const Hit& hit) noexcept;

/// The start of a ray that goes on along `direction` through what it has hit.
V3f origin_behind(const SceneData& scene, const Hit& hit, const V3f& direction) noexcept;

/// The surface at a hit of a ray that came along `direction` (unit length).
LIGHTCULL_CORE_EXPORT Surface make_surface(const SceneData& scene, const Hit& hit,
                                           const V3f& direction) noexcept;

}  // namespace lightcull
