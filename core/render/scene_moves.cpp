#include "render/checks.h"
#include "render/emitter_place.h"
#include "render/scene_data.h"

#include <lightcull/error.h>
#include <lightcull/render/scene.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <variant>

// What moves in a scene that stands.

namespace lightcull {
namespace {

void check_may_move(const SceneData& scene) {
    if (scene.virtual_lights.empty()) return;
    throw Error("scene: nothing can be moved, virtual lights are where paths met what was there");
}

void check_count(const std::string& what, std::size_t count, std::size_t wanted,
                 const char* things) {
    if (count == wanted) return;
    check::fail(
        what, "has " + std::to_string(count) + " elements for " + std::to_string(wanted) + things);
}

/// True if the mesh emits.
bool check_emission(const SceneData& scene, MeshId mesh, const std::string& name,
                    Span<const float3> positions) {
    bool emits = false;
    const SceneData::Range triangles = scene.triangles_of(mesh);
    for (std::size_t i = triangles.begin; i < triangles.end; ++i) {
        if (scene.triangles[i].light == kNone) continue;
        emits = true;
        const auto corner = [&](std::uint32_t k) {
            return positions[scene.corner(static_cast<std::uint32_t>(i), k) -
                             scene.meshes[mesh].first_position];
        };
        check::emissive_area(name, i - triangles.begin, corner(0), corner(1), corner(2));
    }
    return emits;
}

void check_normals(const SceneData& scene, MeshId mesh, const std::string& name, std::size_t count,
                   Span<const float3> normals) {
    if (normals.empty()) return;
    if (scene.meshes[mesh].first_normal == kNone) {
        check::fail(name + ": normals", "are given, and the mesh was added without");
    }
    check_count(name + ": normals", normals.size(), count, " positions");
    for (std::size_t i = 0; i < count; ++i) {
        if (!is_finite(to_v3f(normals[i]))) {
            check::finite(check::element(name + ": normals", i), normals[i]);
        }
    }
}

void replace(SharedArray<V3f>& array, std::size_t first, Span<const float3> values) {
    array.change([&](std::vector<V3f>& all) {
        for (std::size_t i = 0; i < values.size(); ++i) all[first + i] = to_v3f(values[i]);
    });
}

/// The number of emitters of either of two kinds.
template <typename A, typename B>
std::size_t count_of(const SceneData& scene) noexcept {
    const auto is_one = [](const Emitter& emitter) {
        return std::holds_alternative<A>(emitter) || std::holds_alternative<B>(emitter);
    };
    return static_cast<std::size_t>(
        std::count_if(scene.emitters.begin(), scene.emitters.end(), is_one));
}

}  // namespace

void Scene::set_mesh_positions(MeshId mesh, Span<const float3> positions,
                               Span<const float3> normals) {
    SceneData& s = *data_;
    check_may_move(s);
    check::index("set_mesh_positions: mesh", mesh, s.meshes.size(), "meshes");
    const std::string name = "mesh " + std::to_string(mesh);
    if (s.meshes[mesh].is_shared)
        check::fail(name, "is shared: instances of it stay where they are");
    const SceneData::Range range = s.positions_of(mesh);
    check_count(name + ": positions", positions.size(), range.end - range.begin, " corners");
    check::positions(name + ": positions", positions);
    check_normals(s, mesh, name, positions.size(), normals);
    const bool emits = check_emission(s, mesh, name, positions);

    if (emits) s.moved_meshes.push_back(mesh);
    s.is_moved = true;
    replace(s.positions, range.begin, positions);
    if (!normals.empty()) replace(s.normals, s.meshes[mesh].first_normal, normals);
}

void Scene::set_light_positions(Span<const float3> positions) {
    SceneData& s = *data_;
    check_may_move(s);
    const std::string name = "set_light_positions: positions";
    check_count(name, positions.size(), count_of<PointEmitter, SpotEmitter>(s),
                " points and spots");
    check::positions(name, positions);

    s.is_moved = true;
    const float3* next = positions.data();
    for (std::size_t i = 0; i < s.emitters.size(); ++i) {
        if (auto* const point = std::get_if<PointEmitter>(&s.emitters[i])) {
            point->position = to_v3f(*next);
        } else if (auto* const spot = std::get_if<SpotEmitter>(&s.emitters[i])) {
            spot->position = to_v3f(*next);
        } else {
            continue;
        }
        s.lights[i].center = *next++;
    }
}

void Scene::set_light_directions(Span<const float3> directions) {
    SceneData& s = *data_;
    check_may_move(s);
    const std::string name = "set_light_directions: directions";
    check_count(name, directions.size(), count_of<SpotEmitter, DirectionalEmitter>(s),
                " spots and directional lights");
    for (std::size_t i = 0; i < directions.size(); ++i) {
        if (is_finite(to_v3f(directions[i])) && direction(directions[i]) != V3f(0.0f)) continue;
        check::finite(check::element(name, i), directions[i]);
        check::fail(check::element(name, i), "is 0");
    }

    s.is_moved = true;
    const float3* next = directions.data();
    for (std::size_t i = 0; i < s.emitters.size(); ++i) {
        if (auto* const spot = std::get_if<SpotEmitter>(&s.emitters[i])) {
            spot->direction = direction(*next++);
            s.lights[i].axis = directional_light(to_float3(spot->direction), 0.0f).axis;
        } else if (auto* const sun = std::get_if<DirectionalEmitter>(&s.emitters[i])) {
            sun->direction = direction(*next++);
            s.lights[i].axis = directional_light(to_float3(sun->direction), 0.0f).axis;
        }
    }
}

SceneRefit Scene::refit(float max_growth) {
    SceneData& s = *data_;
    if (!s.ray_tracer) throw Error("scene: commit() must come before refit()");
    place_moved_lights(s);
    const SceneRefit result = s.ray_tracer->refit(reach_of(s), max_growth);
    s.is_moved = false;
    ++s.refits;
    return result;
}

}  // namespace lightcull
