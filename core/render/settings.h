#pragma once

#include <lightcull/render/renderer.h>

namespace lightcull {

/// The checks throw Error if rendering cannot begin, or go on.
void check_committed(const Scene& scene);
void check_settings(const RenderSettings& settings);
void check_state(const RenderState& state, const RenderSettings& settings);

}  // namespace lightcull
