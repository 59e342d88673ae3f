#pragma once

#include <lightcull/export.h>
#include <lightcull/float3.h>
#include <lightcull/render/scene.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace lightcull {

/// What was added to a scene, as it is now: to hand it on to another renderer.

struct MeshContents {
    std::vector<float3> positions;
    std::vector<std::uint32_t> indices;  ///< three per triangle
    std::vector<float3> normals;         ///< none or one per position
    std::vector<float2> uvs;             ///< none or one per position
    std::vector<float3> colors;          ///< none or one per position, linear RGB
    MaterialId material = 0;
    std::vector<float3> face_radiance;  ///< radiance of each triangle, texture aside; none if none
                                        ///< emits
    TextureId emission_texture = kNoTexture;
    bool two_sided = false;
};

struct PointContents {
    float3 position, intensity;
};

struct SpotContents {
    float3 position, direction, intensity;  ///< direction: unit length
    float inner = 0.0f, outer = 0.0f;       ///< radians
};

struct DirectionalContents {
    float3 direction, irradiance;  ///< direction: unit length
};

struct SceneContents {
    std::vector<Texture> textures;  ///< all decoded: of linear RGB
    std::vector<Material> materials;
    std::vector<MeshContents> meshes;
    std::vector<PointContents> points;
    std::vector<SpotContents> spots;
    std::vector<DirectionalContents> directional_lights;
    std::optional<Environment> environment;
};

/// A copy of what is in a scene, but for its camera. Throws Error for one with virtual lights,
/// which nobody else knows.
LIGHTCULL_EXPORT SceneContents contents_of(const Scene& scene);

}  // namespace lightcull
