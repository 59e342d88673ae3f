#pragma once

#include "base/core_export.h"
#include "base/shared_array.h"
#include "render/emitter.h"
#include "render/environment.h"
#include "render/instance.h"
#include "render/ray_tracer.h"
#include "render/texture_mean.h"
#include "render/triangle_record.h"
#include "render/vec.h"
#include "render/virtual_emitter.h"

#include <ImathBox.h>
#include <lightcull/light.h>
#include <lightcull/render/scene.h>
#include <lightcull/triangle_cuts.h>

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

namespace lightcull {

/// The properties that the triangles of a mesh have in common; indices into the arrays of
/// SceneData.
struct MeshRecord {
    MaterialId material = 0;
    std::uint32_t first_triangle = 0;
    std::uint32_t first_position = 0;
    std::uint32_t first_normal = kNone;  ///< index of the first normal; kNone: no shading normals
    std::uint32_t first_uv = kNone;      ///< index of the first texture coordinates; kNone: none
    std::uint32_t first_color = kNone;   ///< index of the first colour of a vertex; kNone: none
    TextureId emission_texture = kNoTexture;
    bool is_shared = false;  ///< it stands where instances place it, and nowhere else
    Imath::Box3f bounds{};   ///< bounds of a shared one
};

struct SceneData {
    std::deque<Texture> textures;  ///< these stay where they are: texture_means looks at them
    std::map<TextureId, TextureMean> texture_means;  ///< means of those that emit, until commit()
    std::vector<Material> materials;
    bool has_cut_outs = false;  ///< a mesh has a material that is_cut_out()

    std::vector<MeshRecord> meshes;
    std::vector<Instance> instances;
    SharedArray<TriangleRecord> triangles;
    SharedArray<std::uint32_t> indices;  ///< three per triangle, into positions
    SharedArray<V3f> positions, normals;
    SharedArray<V2f> uvs;
    SharedArray<V3f> colors;

    std::vector<Emitter> emitters;      ///< emitters, or parts of triangles that are cut
    std::vector<Light> lights;          ///< lights of the emitters, one each
    std::vector<float> mean_radiances;  ///< luminances of those that are triangles or parts of
                                        ///< them, means over their areas; may end before lights
    TriangleCuts cuts;                  ///< emissive triangles, cut or not, since commit()
    std::vector<std::uint32_t> part_lights;       ///< lights of the parts of those that are cut
    std::size_t points = 0, spots = 0, suns = 0;  ///< numbers of such emitters
    std::size_t further_parts = 0;  ///< number of lights, the last ones, that are not a triangle's
                                    ///< first part
    std::vector<VirtualLight> virtual_lights;
    float virtual_nearest2 = 0.0f;  ///< square of a distance within which virtual lights fall off
                                    ///< no more

    std::optional<EnvironmentMap> environment;
    Camera camera;
    std::optional<RayTracer> ray_tracer;  ///< present since commit()

    std::vector<MeshId> moved_meshes;  ///< meshes whose lights are not where their triangles are
    bool is_moved = false;             ///< something was moved since commit() or refit()
    std::uint64_t refits = 0;          ///< number of refits so far

    struct Range {
        std::size_t begin, end;
        std::size_t size() const noexcept { return end - begin; }
    };
    /// The positions, and the triangles, that belong to a mesh.
    Range positions_of(MeshId mesh) const noexcept {
        const bool is_last = std::size_t{mesh} + 1 == meshes.size();
        return {meshes[mesh].first_position,
                is_last ? positions.size() : meshes[mesh + 1].first_position};
    }
    Range triangles_of(MeshId mesh) const noexcept {
        const bool is_last = std::size_t{mesh} + 1 == meshes.size();
        return {meshes[mesh].first_triangle,
                is_last ? triangles.size() : meshes[mesh + 1].first_triangle};
    }

    /// Calls visit(mesh, instance) for each mesh where it stands; instance: kNotInstanced, or an
    /// index into instances.
    template <typename Visit>
    void for_each_placed(const Visit& visit) const {
        for (MeshId mesh = 0; mesh < meshes.size(); ++mesh) {
            if (!meshes[mesh].is_shared) visit(mesh, kNotInstanced);
        }
        for (std::uint32_t i = 0; i < instances.size(); ++i) visit(instances[i].mesh, i);
    }

    /// The bytes of all triangles and vertices; shared: of those arrays alone that others share.
    std::size_t geometry_size(bool shared) const noexcept {
        const auto of = [shared](const auto& array) {
            return !shared || array.is_shared() ? array.memory_size() : 0;
        };
        return of(triangles) + of(indices) + of(positions) + of(normals) + of(uvs) + of(colors);
    }

    /// The index of a corner into positions.
    std::uint32_t corner(std::uint32_t triangle, std::uint32_t k) const noexcept {
        return indices[std::size_t{triangle} * 3 + k];
    }
    /// The texture coordinates at a place in a triangle; the mesh must have them.
    V2f uv_at(std::uint32_t triangle, float u, float v) const noexcept {
        const MeshRecord& mesh = meshes[triangles[triangle].mesh];
        const std::uint32_t shift = mesh.first_uv - mesh.first_position;
        return uvs[corner(triangle, 0) + shift] * (1.0f - u - v) +
               uvs[corner(triangle, 1) + shift] * u + uvs[corner(triangle, 2) + shift] * v;
    }
};

/// The box around an instance's box.
LIGHTCULL_CORE_EXPORT Imath::Box3f bounds_of(const SceneData& scene,
                                             const Instance& instance) noexcept;

/// The largest coordinate, but for its sign, of what is in the scene.
float reach_of(const SceneData& scene) noexcept;

/// Builds the ray tracer of a scene, which must have none: else it throws Error.
LIGHTCULL_CORE_EXPORT void make_traceable(SceneData& scene);

/// The inside of a scene, for the rooms of core that render it.
inline const SceneData& data_of(const Scene& scene) noexcept {
    return *scene.data_;
}
inline SceneData& data_of(Scene& scene) noexcept {
    return *scene.data_;
}

}  // namespace lightcull
