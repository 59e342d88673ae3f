#include "scene_contents.h"

#include "arrays.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <vector>

namespace lightcull::python {
namespace {

py::tuple tuple_of(float3 a) {
    return py::make_tuple(a.x, a.y, a.z);
}

/// An array (N, columns) of float32 or uint32; None if it is empty.
template <typename T>
py::object array_of(const std::vector<T>& rows, std::size_t columns, const char* type) {
    if (rows.empty()) return py::none();
    const std::size_t count = rows.size() * sizeof(T) / sizeof(float) / columns;
    py::object array = new_array(py::make_tuple(count, columns), numpy_dtype(py::str(type)));
    std::copy(rows.begin(), rows.end(), elements<T>(array).begin());
    return array;
}

py::dict dict_of(const Material& material) {
    py::dict d;
    d["metallic_roughness"] = material.kind == MaterialKind::kMetallicRoughness;
    d["base_color"] = tuple_of(material.base_color);
    d["metallic"] = material.metallic;
    d["roughness"] = material.roughness;
    d["base_color_texture"] = material.base_color_texture;
    d["metallic_roughness_texture"] = material.metallic_roughness_texture;
    d["opacity"] = material.opacity;
    d["opacity_texture"] = material.opacity_texture;
    d["opacity_threshold"] = material.opacity_threshold;
    d["normal_texture"] = material.normal_texture;
    d["normal_scale"] = material.normal_scale;
    return d;
}

py::dict dict_of(const MeshContents& mesh) {
    py::dict d;
    d["positions"] = array_of(mesh.positions, 3, "float32");
    d["indices"] = array_of(mesh.indices, 3, "uint32");
    d["normals"] = array_of(mesh.normals, 3, "float32");
    d["uvs"] = array_of(mesh.uvs, 2, "float32");
    d["colors"] = array_of(mesh.colors, 3, "float32");
    d["material"] = mesh.material;
    d["face_radiance"] = array_of(mesh.face_radiance, 3, "float32");
    d["emission_texture"] = mesh.emission_texture;
    d["two_sided"] = mesh.two_sided;
    return d;
}

py::dict dict_of(const PointContents& point) {
    py::dict d;
    d["position"] = tuple_of(point.position);
    d["intensity"] = tuple_of(point.intensity);
    return d;
}

py::dict dict_of(const SpotContents& spot) {
    py::dict d;
    d["position"] = tuple_of(spot.position);
    d["direction"] = tuple_of(spot.direction);
    d["intensity"] = tuple_of(spot.intensity);
    d["inner"] = spot.inner;
    d["outer"] = spot.outer;
    return d;
}

py::dict dict_of(const DirectionalContents& sun) {
    py::dict d;
    d["direction"] = tuple_of(sun.direction);
    d["irradiance"] = tuple_of(sun.irradiance);
    return d;
}

py::object array_of(const Texture& texture) {
    return array_from_image(texture.texels, texture.width, texture.height);
}

py::object dict_of(const std::optional<Environment>& environment) {
    if (!environment) return py::none();
    py::dict d;
    d["map"] = array_of(environment->map);
    d["scale"] = tuple_of(environment->scale);
    d["rotation"] = environment->rotation;
    return d;
}

template <typename T>
py::list list_of(const std::vector<T>& values) {
    py::list list;
    for (const T& value : values) {
        if constexpr (std::is_same_v<T, Texture>) {
            list.append(array_of(value));
        } else {
            list.append(dict_of(value));
        }
    }
    return list;
}

}  // namespace

py::dict contents_as_dict(const SceneContents& contents) {
    py::dict d;
    d["textures"] = list_of(contents.textures);
    d["materials"] = list_of(contents.materials);
    d["meshes"] = list_of(contents.meshes);
    d["points"] = list_of(contents.points);
    d["spots"] = list_of(contents.spots);
    d["directional_lights"] = list_of(contents.directional_lights);
    d["environment"] = dict_of(contents.environment);
    return d;
}

}  // namespace lightcull::python
