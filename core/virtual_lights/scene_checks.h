#pragma once

#include "render/scene_data.h"

namespace lightcull {

/// Throws Error if light paths of the scene cannot become virtual lights: if a material is a
/// perfect mirror, or virtual lights are among its emitters.
void check_for_virtual_lights(const SceneData& scene);

}  // namespace lightcull
