#pragma once

#include "render/facet.h"
#include "render/ray.h"
#include "render/scene_data.h"
#include "render/vec.h"

#include <lightcull/render/scene.h>

namespace lightcull {

/// The normal that a material's normal map makes of a surface's own, all of unit length and on one
/// side of the triangle. Texels are in the tangent frame: x towards where u
/// grows, y where v does, both square to the normal. From the back a relief is seen from behind.
/// The normal stays as it is where texture coordinates span nothing.
V3f mapped_normal(const SceneData& scene, const Material& material, const Hit& hit,
                  const Facet& facet, const V3f& normal) noexcept;

/// The normal, bent until what it mirrors to a viewer at `outgoing` is above the surface, whose
/// geometric normal is given: else a polished one would be black there.
V3f bent_to_mirror(const V3f& normal, const V3f& geometric, const V3f& outgoing) noexcept;

}  // namespace lightcull
