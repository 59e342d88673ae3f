#include "render/emitter_place.h"

#include "base/parallel_blocks.h"

#include <cstddef>
#include <variant>
#include <vector>

namespace lightcull {

void place_triangle_light(SceneData& scene, std::uint32_t light) noexcept {
    auto& emitter = *std::get_if<TriangleEmitter>(&scene.emitters[light]);
    const auto corner = [&](std::uint32_t k) {
        return scene.positions[scene.corner(emitter.triangle, k)];
    };
    const V3f a = corner(0), b = corner(1), c = corner(2);
    const float radiance = scene.mean_radiances[light];
    emitter.corner = a;
    emitter.edge1 = b - a;
    emitter.edge2 = c - a;
    if (emitter.part == kNone) {
        scene.lights[light] =
            triangle_light(to_float3(a), to_float3(b), to_float3(c), radiance, emitter.two_sided);
        return;
    }
    const TriangleEmitter part = part_of(emitter, scene.cuts.parts()[emitter.part].corners);
    scene.lights[light] =
        triangle_light(to_float3(part.corner), to_float3(part.corner + part.edge1),
                       to_float3(part.corner + part.edge2), radiance, emitter.two_sided);
    if (!emitter.has_texture) emitter = part;
}

void place_moved_lights(SceneData& scene) {
    if (scene.moved_meshes.empty()) return;
    std::vector<std::uint8_t> is_moved(scene.meshes.size());
    for (const MeshId mesh : scene.moved_meshes) is_moved[mesh] = 1;
    constexpr std::size_t kBlock = 4096;
    for_each_block(scene.emitters.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto* const emitter = std::get_if<TriangleEmitter>(&scene.emitters[i]);
            if (emitter == nullptr) continue;
            if (is_moved[scene.triangles[emitter->triangle].mesh] == 0) continue;
            place_triangle_light(scene, static_cast<std::uint32_t>(i));
        }
    });
    scene.moved_meshes.clear();
}

}  // namespace lightcull
