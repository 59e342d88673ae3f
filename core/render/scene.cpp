#include <lightcull/render/scene.h>

#include "base/memory_size.h"
#include "render/checks.h"
#include "render/cut_outs.h"
#include "render/emitter_cuts.h"
#include "render/emitter_place.h"
#include "render/scene_data.h"
#include "render/texture.h"

#include <lightcull/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace lightcull {
namespace {

void check_not_committed(const SceneData& scene) {
    if (scene.ray_tracer) throw Error("scene: nothing can be changed after commit()");
}

void check_reflectance(const std::string& what, TextureId id, const std::deque<Texture>& all) {
    if (id == kNoTexture) return;
    check::index(what, id, all.size(), "textures");
    // Images that were decoded may be above 1 by rounding.
    constexpr float kMost = 1.001f;
    const auto& texels = all[id].texels;
    const auto found = std::find_if(texels.begin(), texels.end(),
                                    [](float3 t) { return max_component(to_v3f(t)) > kMost; });
    if (found != texels.end()) {
        check::fail(what, "is texture " + std::to_string(id) + ", which has a texel above 1");
    }
}

/// Checks an attribute of which a mesh has none, or one for each of `count` things.
template <typename T>
void check_attribute(const std::string& what, Span<const T> values, std::size_t count,
                     const char* things) {
    if (values.empty()) return;
    if (values.size() != count) {
        check::fail(what, "has " + std::to_string(values.size()) + " elements for " +
                              std::to_string(count) + " " + things);
    }
    for (std::size_t i = 0; i < count; ++i) {
        if constexpr (std::is_same_v<T, float2>) {
            if (std::isfinite(values[i].x) && std::isfinite(values[i].y)) continue;
        } else {
            if (is_finite(to_v3f(values[i]))) continue;
        }
        check::finite(check::element(what, i), values[i]);
    }
}

void check_geometry(const std::string& name, const Mesh& mesh) {
    check::positions(name + ": positions", mesh.positions);
    if (mesh.indices.size() % 3 != 0) {
        check::fail(name + ": indices", "has " + std::to_string(mesh.indices.size()) +
                                            " elements, not three per triangle");
    }
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        if (mesh.indices[i] < mesh.positions.size()) continue;
        check::index(check::element(name + ": indices", i), mesh.indices[i], mesh.positions.size(),
                     "positions");
    }
    check_attribute(name + ": normals", mesh.normals, mesh.positions.size(), "positions");
    check_attribute(name + ": uvs", mesh.uvs, mesh.positions.size(), "positions");
    check_attribute(name + ": colors", mesh.colors, mesh.positions.size(), "positions");
    for (std::size_t i = 0; i < mesh.colors.size(); ++i) {
        const float3 c = mesh.colors[i];
        const float least = std::min({c.x, c.y, c.z}), most = std::max({c.x, c.y, c.z});
        if (least >= 0.0f && most <= 1.0f) continue;
        check::in_unit_range(check::element(name + ": colors", i), least < 0.0f ? least : most);
    }
}

V2f to_vector(float2 a) noexcept {
    return {a.x, a.y};
}
V3f to_vector(float3 a) noexcept {
    return to_v3f(a);
}

/// Adds the attributes of a mesh to those of all. One more stays readable after the last: Embree
/// reads 16 bytes of a position.
template <typename From, typename To>
void append(Span<const From> from, SharedArray<To>& to) {
    to.change([from](std::vector<To>& all) {
        for (const From a : from) all.push_back(to_vector(a));
        all.emplace_back();
        all.pop_back();
    });
}

V3f radiance_of(const Emission& emission, std::size_t triangle) noexcept {
    const V3f radiance = to_v3f(emission.radiance);
    if (emission.face_radiance.empty()) return radiance;
    return radiance * to_v3f(emission.face_radiance[triangle]);
}

void check_areas(const std::string& name, const Mesh& mesh) {
    if (!(luminance(to_v3f(mesh.emission.radiance)) > 0.0f)) return;
    for (std::size_t i = 0; i < mesh.indices.size() / 3; ++i) {
        if (!(luminance(radiance_of(mesh.emission, i)) > 0.0f)) continue;
        const auto corner = [&](std::size_t k) { return mesh.positions[mesh.indices[3 * i + k]]; };
        check::emissive_area(name, i, corner(0), corner(1), corner(2));
    }
}

void check_emission(const std::string& name, const Mesh& mesh, std::size_t texture_count) {
    const Emission& e = mesh.emission;
    check::radiometric(name + ": emission.radiance", e.radiance);
    const std::string faces = name + ": emission.face_radiance";
    check_attribute(faces, e.face_radiance, mesh.indices.size() / 3, "triangles");
    for (std::size_t i = 0; i < e.face_radiance.size(); ++i) {
        const float3 r = e.face_radiance[i];
        if (r.x < 0.0f || r.y < 0.0f || r.z < 0.0f) {
            check::radiometric(check::element(faces, i), r);
        }
    }
    if (e.texture == kNoTexture) return;
    check::index(name + ": emission.texture", e.texture, texture_count, "textures");
    if (mesh.uvs.empty()) check::fail(name + ": emission.texture", "needs uvs");
}

void check_mesh(const std::string& name, const Mesh& mesh, const SceneData& scene) {
    constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max() - 1;
    if (scene.positions.size() + mesh.positions.size() > kMost ||
        scene.triangles.size() + mesh.indices.size() / 3 > kMost) {
        check::fail(name, "does not fit: a scene holds 2^32 positions and triangles");
    }
    check_geometry(name, mesh);
    check::index(name + ": material", mesh.material, scene.materials.size(), "materials");
    const Material& m = scene.materials[mesh.material];
    const bool textured = m.base_color_texture != kNoTexture ||
                          m.metallic_roughness_texture != kNoTexture ||
                          m.opacity_texture != kNoTexture || m.normal_texture != kNoTexture;
    if (textured && mesh.uvs.empty()) {
        check::fail(name + ": material " + std::to_string(mesh.material),
                    "has textures, and the mesh has no uvs");
    }
    check_emission(name, mesh, scene.textures.size());
    check_areas(name, mesh);
}

/// What messages call a light, the next of its kind.
std::string name_of(const char* kind, std::size_t number) {
    return std::string(kind) + " " + std::to_string(number) + ": ";
}

/// Adds lights for the emissive triangles of the mesh that was added last.
void add_triangle_lights(SceneData& scene, const Mesh& mesh) {
    const Emission& e = mesh.emission;
    const std::size_t count = mesh.indices.size() / 3;
    const std::size_t first = scene.triangles.size() - count;
    const TextureMean* texture = nullptr;
    if (e.texture != kNoTexture) {
        texture =
            &scene.texture_means.try_emplace(e.texture, scene.textures[e.texture]).first->second;
    }
    for (std::size_t i = 0; i < count; ++i) {
        const V3f radiance = radiance_of(e, i);
        if (!(luminance(radiance) > 0.0f)) continue;

        const auto triangle = static_cast<std::uint32_t>(first + i);
        float mean = luminance(radiance);
        if (texture != nullptr) {
            mean *=
                texture->over(scene.uv_at(triangle, 0.0f, 0.0f), scene.uv_at(triangle, 1.0f, 0.0f),
                              scene.uv_at(triangle, 0.0f, 1.0f));
        }
        const auto light = static_cast<std::uint32_t>(scene.lights.size());
        scene.triangles.change([&](auto& triangles) { triangles[triangle].light = light; });
        scene.emitters.emplace_back(TriangleEmitter{V3f(0.0f), V3f(0.0f), V3f(0.0f), radiance,
                                                    triangle, kNone, e.two_sided,
                                                    e.texture != kNoTexture});
        scene.lights.emplace_back();
        scene.mean_radiances.resize(scene.lights.size());
        scene.mean_radiances[light] = mean;
        place_triangle_light(scene, light);
    }
}

MeshId add_mesh(SceneData& s, const Mesh& mesh) {
    check_not_committed(s);
    const auto id = static_cast<MeshId>(s.meshes.size());
    const std::string name = "mesh \"" + mesh.name + "\"";
    check_mesh(name, mesh, s);

    MeshRecord record;
    record.material = mesh.material;
    record.first_triangle = static_cast<std::uint32_t>(s.triangles.size());
    record.emission_texture = mesh.emission.texture;
    record.first_position = static_cast<std::uint32_t>(s.positions.size());
    append(mesh.positions, s.positions);
    if (!mesh.normals.empty()) {
        record.first_normal = static_cast<std::uint32_t>(s.normals.size());
        append(mesh.normals, s.normals);
    }
    if (!mesh.uvs.empty()) {
        record.first_uv = static_cast<std::uint32_t>(s.uvs.size());
        append(mesh.uvs, s.uvs);
    }
    if (!mesh.colors.empty()) {
        record.first_color = static_cast<std::uint32_t>(s.colors.size());
        append(mesh.colors, s.colors);
    }
    s.has_cut_outs |= is_cut_out(s.materials[mesh.material]);
    s.indices.change([&](auto& indices) {
        for (const std::uint32_t i : mesh.indices) indices.push_back(record.first_position + i);
    });
    s.meshes.push_back(record);
    s.triangles.change([&](auto& triangles) {
        triangles.resize(triangles.size() + mesh.indices.size() / 3, TriangleRecord{id, kNone});
    });
    add_triangle_lights(s, mesh);
    return id;
}

}  // namespace

Imath::Box3f bounds_of(const SceneData& scene, const Instance& instance) noexcept {
    const Imath::Box3f& box = scene.meshes[instance.mesh].bounds;
    Imath::Box3f placed;
    for (const float x : {box.min.x, box.max.x}) {
        for (const float y : {box.min.y, box.max.y}) {
            for (const float z : {box.min.z, box.max.z}) placed.extendBy(instance.at({x, y, z}));
        }
    }
    return placed;
}

float reach_of(const SceneData& scene) noexcept {
    float reach = max_component(abs(to_v3f(scene.camera.origin))) + scene.camera.aperture_radius +
                  scene.camera.orthographic_height;
    const auto include = [&reach](float x, float y, float z) {
        reach = std::max({reach, std::fabs(x), std::fabs(y), std::fabs(z)});
    };
    for (const V3f& p : scene.positions) include(p.x, p.y, p.z);
    for (const Instance& instance : scene.instances) {
        const Imath::Box3f box = bounds_of(scene, instance);
        include(box.min.x, box.min.y, box.min.z);
        include(box.max.x, box.max.y, box.max.z);
    }
    for (const Light& light : scene.lights) {
        include(light.center.x, light.center.y, light.center.z);
    }
    return reach;
}

void make_traceable(SceneData& scene) {
    check_not_committed(scene);
    place_moved_lights(scene);
    scene.is_moved = false;
    scene.ray_tracer.emplace(scene, reach_of(scene));
}

Scene::Scene() : data_(std::make_unique<SceneData>()) {
}
Scene::~Scene() = default;

TextureId Scene::add_texture(Texture texture) {
    check_not_committed(*data_);
    check::texture("texture " + std::to_string(data_->textures.size()), texture);
    data_->textures.push_back(std::move(texture));
    return static_cast<TextureId>(data_->textures.size() - 1);
}

MaterialId Scene::add_material(const Material& material) {
    check_not_committed(*data_);
    const std::string name = "material " + std::to_string(data_->materials.size()) + ": ";
    if (material.kind != MaterialKind::kDiffuse &&
        material.kind != MaterialKind::kMetallicRoughness) {
        check::fail(name + "kind", "is unknown");
    }
    check::in_unit_range(name + "base_color.x", material.base_color.x);
    check::in_unit_range(name + "base_color.y", material.base_color.y);
    check::in_unit_range(name + "base_color.z", material.base_color.z);
    check::in_unit_range(name + "metallic", material.metallic);
    check::in_unit_range(name + "roughness", material.roughness);
    check::in_unit_range(name + "opacity", material.opacity);
    check::in_unit_range(name + "opacity_threshold", material.opacity_threshold);
    check_reflectance(name + "base_color_texture", material.base_color_texture, data_->textures);
    check_reflectance(name + "opacity_texture", material.opacity_texture, data_->textures);
    check_reflectance(name + "metallic_roughness_texture", material.metallic_roughness_texture,
                      data_->textures);
    if (material.normal_texture != kNoTexture) {
        check::index(name + "normal_texture", material.normal_texture, data_->textures.size(),
                     "textures");
    }
    check::finite(name + "normal_scale", material.normal_scale);
    data_->materials.push_back(material);
    return static_cast<MaterialId>(data_->materials.size() - 1);
}

MeshId Scene::add_mesh(const Mesh& mesh) {
    return lightcull::add_mesh(*data_, mesh);
}

MeshId Scene::add_shared_mesh(const Mesh& mesh) {
    if (luminance(to_v3f(mesh.emission.radiance)) > 0.0f) {
        check::fail("mesh \"" + mesh.name + "\"", "emits: what is shared cannot");
    }
    const MeshId id = lightcull::add_mesh(*data_, mesh);
    MeshRecord& record = data_->meshes[id];
    record.is_shared = true;
    for (const float3 p : mesh.positions) record.bounds.extendBy(to_v3f(p));
    return id;
}

void Scene::add_instance(MeshId mesh, const Placement& placement) {
    SceneData& s = *data_;
    check_not_committed(s);
    const std::string name = name_of("instance", s.instances.size());
    check::index(name + "mesh", mesh, s.meshes.size(), "meshes");
    if (!s.meshes[mesh].is_shared) check::fail(name + "mesh", "is not a shared one");
    for (const auto& row : placement.rows) {
        for (const float number : row) check::finite(name + "placement", number);
    }
    const Instance instance(mesh, placement);
    const float volume = instance.rows[0].dot(instance.rows[1].cross(instance.rows[2]));
    if (!std::isnormal(volume)) check::fail(name + "placement", "makes the mesh flat");
    if (!s.meshes[mesh].bounds.isEmpty()) {
        const Imath::Box3f box = bounds_of(s, instance);
        check::position(name + "placement", to_float3(box.min));
        check::position(name + "placement", to_float3(box.max));
    }
    s.instances.push_back(instance);
}

void Scene::add_point_light(float3 position, float3 intensity) {
    check_not_committed(*data_);
    const std::string name = name_of("point light", data_->points);
    check::position(name + "position", position);
    check::radiometric(name + "intensity", intensity);
    ++data_->points;
    data_->emitters.emplace_back(PointEmitter{to_v3f(position), to_v3f(intensity)});
    data_->lights.push_back(point_light(position, luminance(to_v3f(intensity))));
}

void Scene::add_spot_light(float3 position, float3 direction, float3 intensity, float inner,
                           float outer) {
    check_not_committed(*data_);
    const std::string name = name_of("spot light", data_->spots);
    check::position(name + "position", position);
    check::finite(name + "direction", direction);
    check::radiometric(name + "intensity", intensity);
    const V3f axis = lightcull::direction(direction);
    if (axis == V3f(0.0f)) check::fail(name + "direction", "is 0");
    if (!(inner >= 0.0f && inner <= outer && outer <= kPi)) {
        check::fail(name + "inner and outer", "are not 0 <= inner <= outer <= pi");
    }
    ++data_->spots;
    data_->emitters.emplace_back(
        SpotEmitter{to_v3f(position), to_v3f(intensity), axis, versine(inner), versine(outer)});
    data_->lights.push_back(
        spot_light(position, to_float3(axis), luminance(to_v3f(intensity)), inner, outer));
}

void Scene::add_directional_light(float3 direction, float3 irradiance) {
    check_not_committed(*data_);
    const std::string name = name_of("directional light", data_->suns);
    check::finite(name + "direction", direction);
    check::radiometric(name + "irradiance", irradiance);
    const V3f axis = lightcull::direction(direction);
    if (axis == V3f(0.0f)) check::fail(name + "direction", "is 0");
    ++data_->suns;
    data_->emitters.emplace_back(DirectionalEmitter{axis, to_v3f(irradiance)});
    data_->lights.push_back(directional_light(to_float3(axis), luminance(to_v3f(irradiance))));
}

void Scene::set_environment(Environment environment) {
    check_not_committed(*data_);
    check::texture("environment: map", environment.map);
    if (environment.map.texels.empty()) check::fail("environment: map", "is not of float3");
    check::radiometric("environment: scale", environment.scale);
    check::finite("environment: rotation", environment.rotation);
    const V3f scale = to_v3f(environment.scale);
    for (const float3 texel : environment.map.texels) {
        check::finite("environment: map times scale", to_float3(to_v3f(texel) * scale));
    }
    data_->environment.emplace(std::move(environment));
}

void Scene::set_camera(const Camera& camera) {
    check_not_committed(*data_);
    check::camera(camera);
    data_->camera = camera;
}

void Scene::commit() {
    make_traceable(*data_);
    cut_emitters(*data_);
    data_->texture_means.clear();
}

Span<const Light> Scene::lights() const noexcept {
    return data_->lights;
}
std::size_t Scene::emitter_count() const noexcept {
    return data_->lights.size() - data_->further_parts;
}
std::size_t Scene::triangle_count() const noexcept {
    const SceneData& s = *data_;
    std::size_t count = 0;
    s.for_each_placed([&](MeshId mesh, std::uint32_t) { count += s.triangles_of(mesh).size(); });
    return count;
}
bool Scene::has_environment() const noexcept {
    return data_->environment.has_value();
}
const Camera& Scene::camera() const noexcept {
    return data_->camera;
}
SceneMemory Scene::memory_size() const noexcept {
    const SceneData& s = *data_;
    SceneMemory memory;
    memory.data = size_of(s.materials) + size_of(s.meshes) + size_of(s.instances) +
                  s.geometry_size(false) + size_of(s.emitters) + size_of(s.lights) +
                  size_of(s.mean_radiances) + size_of(s.virtual_lights) + s.cuts.memory_size() +
                  size_of(s.part_lights);
    for (const Texture& texture : s.textures) memory.data += lightcull::memory_size(texture);
    if (s.environment) memory.data += s.environment->memory_size();
    if (s.ray_tracer) memory.bvh = s.ray_tracer->memory_size();
    return memory;
}

}  // namespace lightcull
