#include <lightcull/render/scene_contents.h>

#include "render/scene_data.h"
#include "render/texture.h"

#include <lightcull/error.h>

#include <cmath>
#include <cstddef>
#include <utility>
#include <variant>

namespace lightcull {
namespace {

/// The angle that has this versine.
float angle_of(float versine) noexcept {
    return static_cast<float>(2.0 * std::asin(std::sqrt(0.5 * static_cast<double>(versine))));
}

std::vector<float3> float3s(const SharedArray<V3f>& from, std::size_t begin, std::size_t count) {
    std::vector<float3> result;
    result.reserve(count);
    for (std::size_t i = begin; i < begin + count; ++i) result.push_back(to_float3(from[i]));
    return result;
}

Texture decoded(const Texture& texture) {
    Texture result;
    result.width = texture.width;
    result.height = texture.height;
    result.texels.reserve(std::size_t{texture.width} * texture.height);
    for (std::uint32_t y = 0; y < texture.height; ++y) {
        for (std::uint32_t x = 0; x < texture.width; ++x) {
            result.texels.push_back(to_float3(texel(texture, x, y)));
        }
    }
    return result;
}

MeshContents contents_of(const SceneData& scene, MeshId id) {
    const MeshRecord& mesh = scene.meshes[id];
    const auto [first_position, end_position] = scene.positions_of(id);
    const auto [first_triangle, end_triangle] = scene.triangles_of(id);
    const std::size_t count = end_position - first_position;

    MeshContents contents;
    contents.material = mesh.material;
    contents.emission_texture = mesh.emission_texture;
    contents.positions = float3s(scene.positions, first_position, count);
    if (mesh.first_normal != kNone) {
        contents.normals = float3s(scene.normals, mesh.first_normal, count);
    }
    for (std::size_t i = 0; mesh.first_uv != kNone && i < count; ++i) {
        const V2f uv = scene.uvs[mesh.first_uv + i];
        contents.uvs.push_back({uv.x, uv.y});
    }
    if (mesh.first_color != kNone) {
        contents.colors = float3s(scene.colors, mesh.first_color, count);
    }
    for (std::size_t i = 3 * first_triangle; i < 3 * end_triangle; ++i) {
        contents.indices.push_back(scene.indices[i] - mesh.first_position);
    }
    for (std::size_t i = first_triangle; i < end_triangle; ++i) {
        const std::uint32_t light = scene.triangles[i].light;
        if (light == kNone) continue;
        const auto& emitter = *std::get_if<TriangleEmitter>(&scene.emitters[light]);
        contents.face_radiance.resize(end_triangle - first_triangle);
        contents.face_radiance[i - first_triangle] = to_float3(emitter.radiance);
        contents.two_sided = emitter.two_sided;
    }
    return contents;
}

/// A mesh of its own, where the instance stands; its fronts stay fronts.
MeshContents contents_of(const SceneData& scene, const Instance& instance) {
    MeshContents contents = contents_of(scene, instance.mesh);
    for (float3& p : contents.positions) p = to_float3(instance.at(to_v3f(p)));
    for (float3& n : contents.normals) {
        n = to_float3(instance.normal(to_v3f(n)).normalized());
    }
    for (std::size_t i = 0; instance.is_mirrored && i < contents.indices.size(); i += 3) {
        std::swap(contents.indices[i], contents.indices[i + 2]);
    }
    return contents;
}

}  // namespace

SceneContents contents_of(const Scene& scene) {
    const SceneData& data = data_of(scene);
    if (!data.virtual_lights.empty()) {
        throw Error("scene: it has virtual lights, which no other renderer knows");
    }
    SceneContents contents;
    contents.materials = data.materials;
    for (const Texture& texture : data.textures) contents.textures.push_back(decoded(texture));
    for (MeshId id = 0; id < data.meshes.size(); ++id) {
        if (!data.meshes[id].is_shared) contents.meshes.push_back(contents_of(data, id));
    }
    for (const Instance& instance : data.instances) {
        contents.meshes.push_back(contents_of(data, instance));
    }
    for (const Emitter& emitter : data.emitters) {
        if (const auto* const point = std::get_if<PointEmitter>(&emitter)) {
            contents.points.push_back({to_float3(point->position), to_float3(point->intensity)});
        } else if (const auto* const spot = std::get_if<SpotEmitter>(&emitter)) {
            contents.spots.push_back({to_float3(spot->position), to_float3(spot->direction),
                                      to_float3(spot->intensity), angle_of(spot->inner),
                                      angle_of(spot->outer)});
        } else if (const auto* const sun = std::get_if<DirectionalEmitter>(&emitter)) {
            contents.directional_lights.push_back(
                {to_float3(sun->direction), to_float3(sun->irradiance)});
        }
    }
    if (data.environment) contents.environment = data.environment->description();
    return contents;
}

}  // namespace lightcull
