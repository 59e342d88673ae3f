#include "render/surface.h"

#include "render/facet.h"
#include "render/normal_map.h"
#include "render/scene_data.h"
#include "render/texture.h"

#include <algorithm>

namespace lightcull {
namespace {

/// The interpolated normal, or the geometric one where the mesh has none; on the viewer's side of
/// the surface.
V3f smooth_normal(const SceneData& scene, const MeshRecord& mesh, const Hit& hit,
                  const V3f& normal) noexcept {
    if (mesh.first_normal == kNone) return normal;
    const std::uint32_t shift = mesh.first_normal - mesh.first_position;
    V3f n = scene.normals[scene.corner(hit.triangle, 0) + shift] * (1.0f - hit.u - hit.v) +
            scene.normals[scene.corner(hit.triangle, 1) + shift] * hit.u +
            scene.normals[scene.corner(hit.triangle, 2) + shift] * hit.v;
    if (hit.instance != kNotInstanced) n = scene.instances[hit.instance].normal(n);
    n.normalize();
    if (n == V3f(0.0f)) return normal;
    return n.dot(normal) < 0.0f ? -n : n;
}

/// The normal that light is reflected by: smooth, by the normal map where there is one, and bent
/// until it faces the viewer.
V3f shading_normal(const SceneData& scene, const MeshRecord& mesh, const Hit& hit,
                   const Facet& facet, const V3f& normal, const V3f& outgoing) noexcept {
    const Material& material = scene.materials[mesh.material];
    const bool is_mapped = material.normal_texture != kNoTexture;
    if (mesh.first_normal == kNone && !is_mapped) return normal;
    V3f n = smooth_normal(scene, mesh, hit, normal);
    if (is_mapped) {
        n = mapped_normal(scene, material, hit, facet, n);
        if (material.kind != MaterialKind::kDiffuse) n = bent_to_mirror(n, normal, outgoing);
    }
    constexpr float kMinCosine = 1e-3f;
    const float cosine = n.dot(outgoing);
    return cosine >= kMinCosine ? n : unit(n + outgoing * (kMinCosine - cosine));
}

V3f vertex_color(const SceneData& scene, const MeshRecord& mesh, const Hit& hit) noexcept {
    const std::uint32_t shift = mesh.first_color - mesh.first_position;
    return scene.colors[scene.corner(hit.triangle, 0) + shift] * (1.0f - hit.u - hit.v) +
           scene.colors[scene.corner(hit.triangle, 1) + shift] * hit.u +
           scene.colors[scene.corner(hit.triangle, 2) + shift] * hit.v;
}

Bsdf make_bsdf(const SceneData& scene, const MeshRecord& mesh, const Hit& hit, const V3f& normal,
               const V3f& outgoing) noexcept {
    const Material& m = scene.materials[mesh.material];
    V3f base_color = to_v3f(m.base_color);
    if (m.base_color_texture != kNoTexture) {
        const V3f texel =
            lookup(scene.textures[m.base_color_texture], scene.uv_at(hit.triangle, hit.u, hit.v));
        base_color *=
            V3f(std::min(texel.x, 1.0f), std::min(texel.y, 1.0f), std::min(texel.z, 1.0f));
    }
    if (mesh.first_color != kNone) base_color *= vertex_color(scene, mesh, hit);
    if (m.kind == MaterialKind::kDiffuse) return Bsdf::diffuse(normal, outgoing, base_color);

    float metallic = m.metallic, roughness = m.roughness;
    if (m.metallic_roughness_texture != kNoTexture) {
        const V3f texel = lookup(scene.textures[m.metallic_roughness_texture],
                                 scene.uv_at(hit.triangle, hit.u, hit.v));
        roughness *= std::min(texel.y, 1.0f);
        metallic *= std::min(texel.z, 1.0f);
    }
    return Bsdf::metallic_roughness(normal, outgoing, base_color, metallic, roughness);
}

/// The surface but for its BSDF.
Surface flat_surface(const Facet& facet, const Hit& hit, const V3f& direction) noexcept {
    Surface s;
    s.position = facet.at(hit.u, hit.v);
    s.normal = triangle_normal(facet.edge1, facet.edge2);
    if (s.normal.dot(direction) > 0.0f) s.normal = -s.normal;
    s.origin =
        s.position + s.normal * clearance(s.normal, facet.magnitude, facet.edge1, facet.edge2);
    return s;
}

}  // namespace

V3f hit_position(const SceneData& scene, const Hit& hit) noexcept {
    return Facet(scene, hit.triangle, hit.instance).at(hit.u, hit.v);
}

V3f origin_behind(const SceneData& scene, const Hit& hit, const V3f& direction) noexcept {
    const Surface s = flat_surface(Facet(scene, hit.triangle, hit.instance), hit, direction);
    return s.position + (s.position - s.origin);
}

Surface make_surface(const SceneData& scene, const Hit& hit, const V3f& direction) noexcept {
    const Facet facet(scene, hit.triangle, hit.instance);
    Surface s = flat_surface(facet, hit, direction);
    const MeshRecord& mesh = scene.meshes[scene.triangles[hit.triangle].mesh];
    const V3f outgoing = -direction;
    const V3f normal = shading_normal(scene, mesh, hit, facet, s.normal, outgoing);
    s.bsdf = make_bsdf(scene, mesh, hit, normal, outgoing);
    return s;
}

}  // namespace lightcull
