#include "render/camera_hits.h"

#include "render/surface.h"

#include <cstddef>
#include <vector>

namespace lightcull {
namespace {

bool is_emitter(const SceneData& scene, const Hit& hit) noexcept {
    return hit.triangle != kNoHit && scene.triangles[hit.triangle].light != kNone;
}

}  // namespace

std::uint64_t intersect_camera_rays(const SceneData& scene, bool hide_emitters, Span<Ray> rays,
                                    Span<Hit> hits) {
    scene.ray_tracer->intersect(rays, hits, true);
    std::uint64_t traced = rays.size();
    if (!hide_emitters) return traced;

    std::vector<std::size_t> before_emitters;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (is_emitter(scene, hits[i])) before_emitters.push_back(i);
    }
    std::vector<Ray> behind;
    std::vector<Hit> found;
    while (!before_emitters.empty()) {
        behind.clear();
        for (const std::size_t i : before_emitters) {
            rays[i].origin = origin_behind(scene, hits[i], rays[i].direction);
            behind.push_back(rays[i]);
        }
        found.resize(behind.size());
        scene.ray_tracer->intersect(behind, found, false);
        traced += behind.size();
        std::size_t left = 0;
        for (std::size_t k = 0; k < behind.size(); ++k) {
            const std::size_t i = before_emitters[k];
            hits[i] = found[k];
            if (is_emitter(scene, hits[i])) before_emitters[left++] = i;
        }
        before_emitters.resize(left);
    }
    return traced;
}

}  // namespace lightcull
