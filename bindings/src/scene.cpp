#include <lightcull/error.h>
#include <lightcull/render/preview.h>
#include <lightcull/render/scene.h>

#include "arrays.h"
#include "module.h"
#include "records.h"
#include "scene_contents.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace lightcull::python {
namespace {

Texture map_from_array(const py::object& texels, const char* name) {
    Image image = image_from_array(texels, name);
    Texture texture;
    texture.width = image.width;
    texture.height = image.height;
    texture.texels = std::move(image.pixels);
    return texture;
}

/// The elements of an array of 8 or 16 bits, grey (H, W) or RGB (H, W, 3).
template <typename T>
std::vector<T> read_texels(const py::object& texels, const char* dtype, Texture& texture) {
    ArraySpec spec{numpy_dtype(py::str(dtype)), {-1, -1, 3}};
    const bool is_grey = py::len(texels.attr("shape")) == 2;
    if (is_grey) spec.shape.pop_back();
    const py::buffer_info info = read_array(texels, "texture", spec);
    texture.height = static_cast<std::uint32_t>(info.shape[0]);
    texture.width = static_cast<std::uint32_t>(info.shape[1]);
    texture.channels = is_grey ? 1 : 3;
    const auto* const first = static_cast<const T*>(info.ptr);
    return std::vector<T>(first, first + info.size);
}

TextureId add_texture(Scene& scene, const py::object& texels, bool linear_data) {
    const std::string dtype =
        py::hasattr(texels, "dtype") ? std::string(py::str(texels.attr("dtype"))) : "";
    if (dtype != "uint8" && dtype != "uint16") {
        return scene.add_texture(map_from_array(texels, "texture"));
    }
    Texture texture;
    texture.is_srgb = !linear_data;
    if (dtype == "uint8") texture.texels8 = read_texels<std::uint8_t>(texels, "uint8", texture);
    if (dtype == "uint16") texture.texels16 = read_texels<std::uint16_t>(texels, "uint16", texture);
    return scene.add_texture(std::move(texture));
}

MaterialId add_material(Scene& scene, bool metallic_roughness, const py::object& base_color,
                        float metallic, float roughness, TextureId base_color_texture,
                        TextureId metallic_roughness_texture, float opacity,
                        TextureId opacity_texture, float opacity_threshold,
                        TextureId normal_texture, float normal_scale) {
    Material material;
    material.kind = metallic_roughness ? MaterialKind::kMetallicRoughness : MaterialKind::kDiffuse;
    material.base_color = float3_from(base_color, "base_color");
    material.metallic = metallic;
    material.roughness = roughness;
    material.base_color_texture = base_color_texture;
    material.metallic_roughness_texture = metallic_roughness_texture;
    material.opacity = opacity;
    material.opacity_texture = opacity_texture;
    material.opacity_threshold = opacity_threshold;
    material.normal_texture = normal_texture;
    material.normal_scale = normal_scale;
    return scene.add_material(material);
}

MeshId add_mesh(Scene& scene, const std::string& name, const py::object& positions,
                const py::object& indices, const py::object& normals, const py::object& uvs,
                const py::object& colors, MaterialId material, const py::object& radiance,
                const py::object& face_radiance, TextureId texture, bool two_sided, bool shared) {
    const Rows<float3> position_rows(positions, "positions");
    const Rows<Triangle> triangles(indices, "indices");
    const auto normal_rows = Rows<float3>::optional(normals, "normals", position_rows.size());
    const auto uv_rows = Rows<float2>::optional(uvs, "uvs", position_rows.size());
    const auto color_rows = Rows<float3>::optional(colors, "colors", position_rows.size());
    const auto face_rows = Rows<float3>::optional(face_radiance, "radiance", triangles.size());

    Mesh mesh;
    mesh.name = name;
    mesh.positions = position_rows.span();
    if (!triangles.span().empty())
        mesh.indices = {triangles.span().data()->data(), triangles.span().size() * 3};
    mesh.normals = normal_rows.span();
    mesh.uvs = uv_rows.span();
    mesh.colors = color_rows.span();
    mesh.material = material;
    mesh.emission.radiance = float3_from(radiance, "radiance");
    mesh.emission.face_radiance = face_rows.span();
    mesh.emission.texture = texture;
    mesh.emission.two_sided = two_sided;
    return shared ? scene.add_shared_mesh(mesh) : scene.add_mesh(mesh);
}

void add_instance(Scene& scene, MeshId mesh, const std::vector<float>& numbers) {
    Placement placement{};
    if (numbers.size() != 12) throw Error("instance: its transform is not of 3 rows of 4 numbers");
    std::copy(numbers.begin(), numbers.end(), &placement.rows[0][0]);
    scene.add_instance(mesh, placement);
}

void add_spot_light(Scene& scene, const py::object& position, const py::object& direction,
                    const py::object& intensity, float inner, float outer) {
    scene.add_spot_light(float3_from(position, "position"), float3_from(direction, "direction"),
                         float3_from(intensity, "intensity"), inner, outer);
}

void set_environment(Scene& scene, const py::object& map, const py::object& scale, float rotation) {
    scene.set_environment(
        {map_from_array(map, "environment"), float3_from(scale, "scale"), rotation});
}

Camera camera_from(const py::object& origin, const py::object& target, const py::object& up,
                   float vertical_fov, float aperture_radius, float focus_distance,
                   float orthographic_height) {
    Camera camera;
    camera.origin = float3_from(origin, "origin");
    camera.target = float3_from(target, "target");
    camera.up = float3_from(up, "up");
    camera.vertical_fov = vertical_fov;
    camera.aperture_radius = aperture_radius;
    camera.focus_distance = focus_distance;
    camera.orthographic_height = orthographic_height;
    return camera;
}

void set_camera(Scene& scene, const py::object& origin, const py::object& target,
                const py::object& up, float vertical_fov, float aperture_radius,
                float focus_distance, float orthographic_height) {
    scene.set_camera(camera_from(origin, target, up, vertical_fov, aperture_radius, focus_distance,
                                 orthographic_height));
}

void set_mesh_positions(Scene& scene, MeshId mesh, const py::object& positions,
                        const py::object& normals) {
    const Rows<float3> position_rows(positions, "positions");
    const auto normal_rows = Rows<float3>::optional(normals, "normals", position_rows.size());
    scene.set_mesh_positions(mesh, position_rows.span(), normal_rows.span());
}

py::object lights_of(const Scene& scene) {
    const Span<const Light> lights = scene.lights();
    py::object array = new_array(py::make_tuple(lights.size()), light_dtype());
    std::copy(lights.begin(), lights.end(), elements<Light>(array).begin());
    return array;
}

py::object distances(const Preview& preview, const py::object& origins,
                     const py::object& directions) {
    const Rows<float3> from(origins, "origins");
    const Rows<float3> along(directions, "directions", from.size());
    const std::vector<float> found = preview.distances(from.span(), along.span());
    py::object array = new_array(py::make_tuple(found.size()), numpy_dtype(py::str("float32")));
    std::copy(found.begin(), found.end(), elements<float>(array).begin());
    return array;
}

py::object look(Preview& preview, const py::object& origin, const py::object& target,
                const py::object& up, float vertical_fov, float aperture_radius,
                float focus_distance, float orthographic_height, std::uint32_t width,
                std::uint32_t height, std::uint32_t passes) {
    const Camera camera = camera_from(origin, target, up, vertical_fov, aperture_radius,
                                      focus_distance, orthographic_height);
    std::vector<float3> pixels;
    {
        const py::gil_scoped_release release;
        pixels = preview.look(camera, width, height, passes);
    }
    return array_from_image(pixels, width, height);
}

}  // namespace

void bind_scene(py::module_& module) {
    module.attr("NO_TEXTURE") = kNoTexture;
    py::class_<SceneMemory>(module, "SceneMemory")
        .def_readonly("data", &SceneMemory::data)
        .def_readonly("bvh", &SceneMemory::bvh);
    py::class_<Scene, std::shared_ptr<Scene>>(module, "Scene")
        .def(py::init<>())
        .def("add_texture", &add_texture)
        .def("add_material", &add_material)
        .def("add_mesh", &add_mesh)
        .def("add_instance", &add_instance)
        .def("add_point_light",
             [](Scene& scene, const py::object& position, const py::object& intensity) {
                 scene.add_point_light(float3_from(position, "position"),
                                       float3_from(intensity, "intensity"));
             })
        .def("add_spot_light", &add_spot_light)
        .def("add_directional_light",
             [](Scene& scene, const py::object& direction, const py::object& irradiance) {
                 scene.add_directional_light(float3_from(direction, "direction"),
                                             float3_from(irradiance, "irradiance"));
             })
        .def("set_environment", &set_environment)
        .def("set_camera", &set_camera)
        .def("commit", &Scene::commit, py::call_guard<py::gil_scoped_release>())
        .def("set_mesh_positions", &set_mesh_positions)
        .def("set_light_positions",
             [](Scene& scene, const py::object& positions) {
                 scene.set_light_positions(Rows<float3>(positions, "positions").span());
             })
        .def("set_light_directions",
             [](Scene& scene, const py::object& directions) {
                 scene.set_light_directions(Rows<float3>(directions, "directions").span());
             })
        .def("refit",
             [](Scene& scene) {
                 const py::gil_scoped_release release;
                 const SceneRefit done = scene.refit();
                 return std::make_pair(done.rebuilt, done.growth);
             })
        .def("contents", [](const Scene& scene) { return contents_as_dict(contents_of(scene)); })
        .def("lights", &lights_of)
        .def("light_count", [](const Scene& scene) { return scene.lights().size(); })
        .def("emitter_count", &Scene::emitter_count)
        .def("triangle_count", &Scene::triangle_count)
        .def("has_environment", &Scene::has_environment)
        .def("memory_size", &Scene::memory_size);
    py::class_<Preview>(module, "Preview")
        .def(py::init<const Scene&>(), py::call_guard<py::gil_scoped_release>())
        .def("distances", &distances)
        .def("memory_size", &Preview::memory_size)
        .def("look", &look);
}

}  // namespace lightcull::python
