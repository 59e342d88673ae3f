#include "virtual_lights/view/camera_view.h"

#include "base/parallel_blocks.h"
#include "render/camera_hits.h"

namespace lightcull {
namespace {

void trace_block(const SceneData& scene, bool hide_emitters, const PassRays& camera_rays,
                 std::size_t begin, std::size_t end, CameraView& view) {
    std::vector<Ray> rays;
    std::vector<Hit> hits(end - begin);
    for (std::size_t i = begin; i < end; ++i) {
        rays.push_back(camera_rays.ray(static_cast<std::uint32_t>(i)));
    }
    intersect_camera_rays(scene, hide_emitters, rays, hits);
    const CameraRays& camera = camera_rays.camera();
    for (std::size_t i = begin; i < end; ++i) {
        const Hit& hit = hits[i - begin];
        if (hit.triangle == kNoHit) continue;
        view.hit[i] = 1;
        view.surfaces[i] = make_surface(scene, hit, rays[i - begin].direction);
        view.view_positions[i] = camera.to_view(view.surfaces[i].position - camera.origin());
    }
}

}  // namespace

CameraView trace_camera_view(const SceneData& scene, const RenderSettings& settings,
                             const PassRays& camera_rays) {
    CameraView view;
    view.width = settings.width;
    view.height = settings.height;
    const std::size_t pixels = std::size_t{view.width} * view.height;
    view.hit.resize(pixels);
    view.surfaces.resize(pixels);
    view.view_positions.resize(pixels);
    constexpr std::size_t kBlock = 4096;
    for_each_block(pixels, kBlock, [&](std::size_t begin, std::size_t end) {
        trace_block(scene, settings.hide_emitters, camera_rays, begin, end, view);
    });
    return view;
}

}  // namespace lightcull
