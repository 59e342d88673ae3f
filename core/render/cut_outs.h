#pragma once

#include "base/core_export.h"
#include "render/ray.h"
#include "render/vec.h"

#include <lightcull/render/scene.h>

#include <cstdint>

namespace lightcull {

/// Whether rays may go through a surface of the material.
bool is_cut_out(const Material& material) noexcept;

/// The probability with which a ray meets a triangle at a place.
LIGHTCULL_CORE_EXPORT float opacity_at(const SceneData& scene, std::uint32_t triangle, float u,
                                       float v) noexcept;

/// Whether a ray meets what it hits, or goes on. The answer is a hash of the ray and the triangle:
/// asked twice, it is the same, and independent from ray to ray and from triangle to triangle.
bool meets(const SceneData& scene, const Hit& hit, const V3f& origin,
           const V3f& direction) noexcept;

}  // namespace lightcull
