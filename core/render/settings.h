#pragma once

#include <lightcull/render/renderer.h>

namespace lightcull {

/// Throw Error if rendering cannot begin.
void check_committed(const Scene& scene);
void check_settings(const RenderSettings& settings);

}  // namespace lightcull
