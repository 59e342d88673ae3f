#pragma once

#include "render/camera.h"
#include "render/ray_tracer.h"
#include "virtual_lights/light/virtual_light.h"
#include "virtual_lights/maps/point_cloud.h"
#include "virtual_lights/view/camera_view.h"
#include "virtual_lights/volumes/acceptance.h"

#include <lightcull/span.h>
#include <lightcull/virtual_lights/virtual_light_renderer.h>

#include <atomic>
#include <cstdint>
#include <vector>

namespace lightcull {

/// The data that all methods need to know of a pass.
struct LightingPass {
    const RayTracer& tracer;
    const CameraRays& camera;
    const CameraView& view;
    const VirtualLightOptions& options;
    std::uint64_t key;                  ///< key of the pass's random numbers
    const std::atomic<bool>* cancel;    ///< may be null
    const PointCloud* cloud = nullptr;  ///< points for shadows by maps, else not needed
    Span<LightsOfPixel> of_pixels{};  ///< counts that are increased, but not by kGrid; may be empty

    bool cancelled() const noexcept {
        return cancel != nullptr && cancel->load(std::memory_order_relaxed);
    }
};

/// The counts that VirtualLightStats documents.
struct LightingCounts {
    std::uint64_t listed = 0, accepted = 0, shadow_rays = 0, map_points = 0;
    double build_seconds = 0.0;

    LightingCounts& operator+=(const LightingCounts& other) noexcept {
        listed += other.listed;
        accepted += other.accepted;
        shadow_rays += other.shadow_rays;
        return *this;
    }
};

/// The square of the distance within which light falls off no more, which VirtualLightRenderer
/// documents.
float nearest_distance2(const std::vector<VirtualLight>& lights) noexcept;

/// Adds to each pixel the light of virtual lights that its surface sends to the camera: stochastic
/// tiled lighting, Alg. 1 of [TH16], within interleaved sampling. Runs in the caller's TBB arena.
/// Throws Error for more lights than there can be shadow maps.
LightingCounts add_tiled_lighting(const LightingPass& pass, const std::vector<VirtualLight>& lights,
                                  const Acceptance& acceptance, Span<V3f> pixels);

}  // namespace lightcull
