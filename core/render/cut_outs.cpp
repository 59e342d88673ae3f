#include "render/cut_outs.h"

#include "base/random.h"
#include "render/scene_data.h"
#include "render/texture.h"

#include <algorithm>
#include <cstring>

namespace lightcull {
namespace {

const Material& material_of(const SceneData& scene, std::uint32_t triangle) noexcept {
    return scene.materials[scene.meshes[scene.triangles[triangle].mesh].material];
}

std::uint64_t bits_of(float a, float b) noexcept {
    const float pair[] = {a, b};
    std::uint64_t bits;
    std::memcpy(&bits, pair, sizeof bits);
    return bits;
}

}  // namespace

bool is_cut_out(const Material& material) noexcept {
    return material.opacity < 1.0f || material.opacity_texture != kNoTexture;
}

float opacity_at(const SceneData& scene, std::uint32_t triangle, float u, float v) noexcept {
    const Material& m = material_of(scene, triangle);
    float opacity = m.opacity;
    if (m.opacity_texture != kNoTexture) {
        const V3f texel = lookup(scene.textures[m.opacity_texture], scene.uv_at(triangle, u, v));
        opacity *= std::min(texel.x, 1.0f);
    }
    if (m.opacity_threshold > 0.0f) return opacity >= m.opacity_threshold ? 1.0f : 0.0f;
    return opacity;
}

bool meets(const SceneData& scene, const Hit& hit, const V3f& origin,
           const V3f& direction) noexcept {
    if (!is_cut_out(material_of(scene, hit.triangle))) return true;
    const float opacity = opacity_at(scene, hit.triangle, hit.u, hit.v);
    if (opacity <= 0.0f) return false;
    if (opacity >= 1.0f) return true;
    const std::uint64_t ray = hash(bits_of(origin.x, origin.y), bits_of(origin.z, direction.x),
                                   bits_of(direction.y, direction.z));
    const std::uint64_t place = hash(ray, hit.triangle);
    const bool is_instance = hit.instance != kNotInstanced;
    return uniform_float(is_instance ? hash(place, hit.instance) : place) < opacity;
}

}  // namespace lightcull
