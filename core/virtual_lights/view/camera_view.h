#pragma once

#include "render/pass_rays.h"
#include "render/scene_data.h"
#include "render/surface.h"

#include <lightcull/render/renderer.h>

#include <cstdint>
#include <vector>

namespace lightcull {

/// The surfaces that one camera ray per pixel meets, row by row.
struct CameraView {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> hit;  ///< 1 where there is a surface
    std::vector<Surface> surfaces;
    std::vector<V3f> view_positions;  ///< positions to the right, up and forward of the camera

    std::size_t index(std::uint32_t x, std::uint32_t y) const noexcept {
        return std::size_t{y} * width + x;
    }
};

/// Traces the view by the rays of a pass of the path tracer. Runs in the caller's TBB arena.
CameraView trace_camera_view(const SceneData& scene, const RenderSettings& settings,
                             const PassRays& camera_rays);

}  // namespace lightcull
