#pragma once

#include "render/scene_data.h"

#include <cstdint>

namespace lightcull {

/// Puts a light, and its emitter, where the triangle lies that it is, or is a part of, by the mean
/// radiance that the scene has of it.
void place_triangle_light(SceneData& scene, std::uint32_t light) noexcept;

/// Does that for all lights of meshes that have been moved.
void place_moved_lights(SceneData& scene);

}  // namespace lightcull
