#pragma once

#include "render/ray.h"
#include "render/scene_data.h"

#include <lightcull/span.h>

#include <cstdint>

namespace lightcull {

/// What camera rays meet first: hits[i] is that of rays[i]. Where emitters are hidden, rays go on
/// through the triangles that emit, and rays[i] begins behind the last of them. Returns the number
/// of rays traced.
std::uint64_t intersect_camera_rays(const SceneData& scene, bool hide_emitters, Span<Ray> rays,
                                    Span<Hit> hits);

}  // namespace lightcull
