#include "render/normal_map.h"

#include "render/texture.h"

#include <algorithm>

namespace lightcull {
namespace {

/// A texel as a vector of the tangent frame; of any length.
V3f texel_normal(const SceneData& scene, const Material& material, const Hit& hit) noexcept {
    const V3f texel =
        lookup(scene.textures[material.normal_texture], scene.uv_at(hit.triangle, hit.u, hit.v));
    const V3f n = texel * 2.0f - V3f(1.0f);
    return {n.x * material.normal_scale, n.y * material.normal_scale, n.z};
}

}  // namespace

V3f mapped_normal(const SceneData& scene, const Material& material, const Hit& hit,
                  const Facet& facet, const V3f& normal) noexcept {
    const V3f &edge1 = facet.edge1, &edge2 = facet.edge2;
    const V2f uv = scene.uv_at(hit.triangle, 0.0f, 0.0f);
    const V2f along1 = scene.uv_at(hit.triangle, 1.0f, 0.0f) - uv;
    const V2f along2 = scene.uv_at(hit.triangle, 0.0f, 1.0f) - uv;
    const float turn = along1.x * along2.y - along1.y * along2.x > 0.0f ? 1.0f : -1.0f;
    // Where u and v grow, but for the lengths.
    const V3f of_u = (edge1 * along2.y - edge2 * along1.y) * turn;
    const V3f of_v = (edge2 * along1.x - edge1 * along2.x) * turn;
    V3f tangent = of_u - normal * normal.dot(of_u);
    tangent.normalize();
    V3f bitangent = normal.cross(tangent);
    if (bitangent.dot(of_v) < 0.0f) bitangent = -bitangent;

    const V3f texel = texel_normal(scene, material, hit);
    const bool is_back = (edge1.cross(edge2).dot(normal) < 0.0f) != facet.is_mirrored;
    const float side = is_back ? -1.0f : 1.0f;
    V3f mapped = normal * texel.z + (tangent * texel.x + bitangent * texel.y) * side;
    mapped.normalize();
    return mapped == V3f(0.0f) ? normal : mapped;
}

V3f bent_to_mirror(const V3f& normal, const V3f& geometric, const V3f& outgoing) noexcept {
    constexpr float kAbove = 0.01f, kPartOfView = 0.9f;
    const V3f mirrored = normal * (2.0f * normal.dot(outgoing)) - outgoing;
    const float above = std::min(kAbove, kPartOfView * geometric.dot(outgoing));
    const float height = mirrored.dot(geometric);
    if (height >= above) return normal;
    return unit(outgoing + unit(mirrored + geometric * (above - height)));
}

}  // namespace lightcull
