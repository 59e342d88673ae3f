#pragma once

#include "render/scene_data.h"

namespace lightcull {

/// Cuts the emissive triangles of a scene that can be traced, where they are long beside their
/// distance to what they light, or their texture is uneven. The first part of a triangle takes the
/// place of its light; the lights of all others come last.
void cut_emitters(SceneData& scene);

}  // namespace lightcull
