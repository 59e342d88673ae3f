#pragma once

#include "virtual_lights/view/camera_view.h"

#include <vector>

namespace lightcull {

/// Smooths one number per pixel within surfaces, and not across its own edges: the edge-avoiding
/// a-trous wavelet filter (Dammertz et al. 2010), which [LY19] section 3.3 takes for shadows.
/// Pixels whose number is negative have none. Runs in the caller's TBB arena.
void filter_a_trous(const CameraView& view, std::vector<float>& values);

}  // namespace lightcull
