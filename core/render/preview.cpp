#include <lightcull/render/preview.h>

#include "render/checks.h"
#include "render/facet.h"
#include "render/ray_tracer.h"
#include "render/scene_data.h"

#include <lightcull/error.h>
#include <lightcull/render/renderer.h>

#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

namespace lightcull {
namespace {

/// Fills a scene with what another has, but for reflectance textures, which take most of its
/// memory. Triangles and vertices are shared.
void copy(const SceneData& from, SceneData& to) {
    std::vector<bool> is_kept(from.textures.size(), false);
    for (const MeshRecord& mesh : from.meshes) {
        const TextureId textures[] = {mesh.emission_texture,
                                      from.materials[mesh.material].opacity_texture};
        for (const TextureId texture : textures) {
            if (texture != kNoTexture) is_kept[texture] = true;
        }
    }
    for (std::size_t i = 0; i < from.textures.size(); ++i) {
        const Texture grey{1, 1, {{0.5f, 0.5f, 0.5f}}};
        to.textures.push_back(is_kept[i] ? from.textures[i] : grey);
    }
    to.texture_means = from.texture_means;
    to.materials = from.materials;
    to.has_cut_outs = from.has_cut_outs;
    to.meshes = from.meshes;
    to.instances = from.instances;
    to.triangles = from.triangles;
    to.indices = from.indices;
    to.positions = from.positions;
    to.normals = from.normals;
    to.uvs = from.uvs;
    to.colors = from.colors;
    to.emitters = from.emitters;
    to.lights = from.lights;
    to.mean_radiances = from.mean_radiances;
    to.moved_meshes = from.moved_meshes;
    to.virtual_lights = from.virtual_lights;
    to.virtual_nearest2 = from.virtual_nearest2;
    to.environment = from.environment;
    to.camera = from.camera;
}

}  // namespace

Preview::Preview(const Scene& scene) : copy_(std::make_shared<Scene>()) {
    if (data_of(scene).ray_tracer) throw Error("preview: the scene is committed");
    copy(data_of(scene), data_of(*copy_));
    copy_->commit();
}
Preview::~Preview() = default;

std::vector<float> Preview::distances(Span<const float3> origins,
                                      Span<const float3> directions) const {
    const SceneData& scene = data_of(*copy_);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < origins.size(); ++i) {
        rays.push_back({to_v3f(origins[i]), to_v3f(directions[i])});
    }
    std::vector<Hit> hits(rays.size());
    scene.ray_tracer->intersect(rays, hits, false);
    std::vector<float> found(rays.size(), std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].triangle == kNoHit) continue;
        const Facet facet(scene, hits[i].triangle, hits[i].instance);
        const V3f way = facet.at(hits[i].u, hits[i].v) - rays[i].origin;
        const V3f& d = rays[i].direction;
        const float distance = way.length() / d.length();
        const bool is_back = d.dot(facet.edge1.cross(facet.edge2)) > 0.0f;
        found[i] = is_back != facet.is_mirrored ? -distance : distance;
    }
    return found;
}

SceneMemory Preview::memory_size() const noexcept {
    SceneMemory memory = copy_->memory_size();
    memory.data -= data_of(*copy_).geometry_size(true);
    return memory;
}

std::vector<float3> Preview::look(const Camera& camera, std::uint32_t width, std::uint32_t height,
                                  std::uint32_t passes) {
    check::camera(camera);
    data_of(*copy_).camera = camera;
    RenderSettings settings;
    settings.width = width;
    settings.height = height;
    Renderer renderer(copy_, settings, make_scene_sampler("light_bvh", *copy_, settings));
    for (std::uint32_t pass = 0; pass < passes; ++pass) renderer.render_pass();
    std::vector<float3> pixels = renderer.image();
    const std::vector<std::optional<ShadingPoint>> seen = pixel_points(*copy_, settings);
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (!seen[i]) pixels[i] = {kNone, kNone, kNone};
    }
    return pixels;
}

}  // namespace lightcull
