#pragma once

#include "virtual_lights/view/camera_view.h"

#include <lightcull/span.h>

#include <vector>

namespace lightcull {

/// Makes each pixel a mean over the 17 x 17 about it, of those whose surfaces lie in about the same
/// plane ([TH16] section 4.2, [TH17] section 6). The reflectance of the surfaces is divided out
/// before and multiplied in again. Runs in the caller's TBB arena.
void filter_cross_bilateral(const CameraView& view, Span<V3f> pixels);

}  // namespace lightcull
