#include "unit/render/render_support.h"

#include <doctest/doctest.h>
#include <lightcull/error.h>

#include <functional>
#include <limits>
#include <string>

using namespace render_support;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The text of the error that the function throws.
std::string error_of(const std::function<void()>& function) {
    try {
        function();
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing was thrown";
}

Shape unit_square() {
    Shape s;
    s.add_quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
    return s;
}

std::string mesh_error(const std::function<void(Mesh&)>& spoil) {
    Scene scene;
    scene.add_texture({1, 1, {{1, 1, 1}}});
    scene.add_material(diffuse(0.5f));
    Material textured = diffuse(0.5f);
    textured.base_color_texture = 0;
    scene.add_material(textured);
    const Shape shape = unit_square();
    Mesh mesh = shape.mesh("floor", 0);
    spoil(mesh);
    return error_of([&] { scene.add_mesh(mesh); });
}

std::string material_error(const std::function<void(Material&)>& spoil) {
    Scene scene;
    scene.add_texture({1, 1, {{1, 2, 1}}});
    Material material;
    spoil(material);
    return error_of([&] { scene.add_material(material); });
}

std::string camera_error(const std::function<void(Camera&)>& spoil) {
    Scene scene;
    Camera camera;
    spoil(camera);
    return error_of([&] { scene.set_camera(camera); });
}

}  // namespace

TEST_CASE("a mesh that is wrong is refused by name, field and index") {
    const std::vector<float3> two(2), bad{{0, 0, 0}, {0, 0, 0}, {0, kNan, 0}, {0, 0, 0}};
    const std::vector<float3> far{{0, 0, 0}, {0, 0, -2e15f}, {0, 0, 0}, {0, 0, 0}};
    const std::vector<float3> faces{{1, 1, 1}, {0, -1, 0}};
    const std::vector<std::uint32_t> beyond{0, 1, 4}, four{0, 1, 2, 3};
    CHECK(mesh_error([](Mesh&) {}) == "nothing was thrown");
    // Nobody looks at any of them before they are counted.
    const Span<const float3> many_positions(two.data(), std::size_t{1} << 32);
    const Span<const std::uint32_t> many_indices(four.data(), std::size_t{3} << 32);
    const std::string too_many =
        "mesh \"floor\" does not fit: a scene holds 2^32 positions and triangles";
    CHECK(mesh_error([&](Mesh& m) { m.positions = many_positions; }) == too_many);
    CHECK(mesh_error([&](Mesh& m) { m.indices = many_indices; }) == too_many);
    CHECK(mesh_error([&](Mesh& m) { m.positions = bad; }) ==
          "mesh \"floor\": positions[2] is not finite");
    CHECK(mesh_error([&](Mesh& m) { m.positions = far; }) ==
          "mesh \"floor\": positions[1] is above 1e15");
    CHECK(mesh_error([&](Mesh& m) { m.indices = beyond; }) ==
          "mesh \"floor\": indices[2] is 4, but there are 4 positions");
    CHECK(mesh_error([&](Mesh& m) { m.indices = four; }) ==
          "mesh \"floor\": indices has 4 elements, not three per triangle");
    CHECK(mesh_error([&](Mesh& m) { m.normals = two; }) ==
          "mesh \"floor\": normals has 2 elements for 4 positions");
    CHECK(mesh_error([&](Mesh& m) { m.normals = bad; }) ==
          "mesh \"floor\": normals[2] is not finite");
    const std::vector<float2> two_uvs(2);
    CHECK(mesh_error([&](Mesh& m) { m.uvs = two_uvs; }) ==
          "mesh \"floor\": uvs has 2 elements for 4 positions");
    for (const float2 uv : {float2{kNan, 0}, float2{0, kNan}}) {
        const std::vector<float2> uvs{{0, 0}, uv, {0, 0}, {0, 0}};
        CHECK(mesh_error([&](Mesh& m) { m.uvs = uvs; }) == "mesh \"floor\": uvs[1] is not finite");
    }
    CHECK(mesh_error([](Mesh& m) { m.material = 2; }) ==
          "mesh \"floor\": material is 2, but there are 2 materials");
    CHECK(mesh_error([](Mesh& m) { m.material = 1; }) ==
          "mesh \"floor\": material 1 has textures, and the mesh has no uvs");
    CHECK(mesh_error([](Mesh& m) { m.emission.radiance.z = kNan; }) ==
          "mesh \"floor\": emission.radiance is not finite");
    CHECK(mesh_error([&](Mesh& m) { m.emission.face_radiance = bad; }) ==
          "mesh \"floor\": emission.face_radiance has 4 elements for 2 triangles");
    CHECK(mesh_error([&](Mesh& m) { m.emission.face_radiance = faces; }) ==
          "mesh \"floor\": emission.face_radiance[1] is negative");
    CHECK(mesh_error([](Mesh& m) { m.emission.texture = 7; }) ==
          "mesh \"floor\": emission.texture is 7, but there are 1 textures");
    CHECK(mesh_error([](Mesh& m) { m.emission.texture = 0; }) ==
          "mesh \"floor\": emission.texture needs uvs");
}

TEST_CASE("textures, materials, lights, environments and cameras are checked") {
    Scene scene;
    CHECK(error_of([&] { scene.add_texture({}); }) == "texture 0 has no texels");
    CHECK(error_of([&] {
              scene.add_texture({2, 2, {{0, 0, 0}}});
          }) == "texture 0 has 1 texels, not 2 x 2");
    CHECK(error_of([&] {
              scene.add_texture({2, 1, {{0, 0, 0}, {0, kNan, 0}}});
          }) == "texture 0: texels[1] is not finite");
    Texture encoded{2, 1, {}};
    encoded.texels8 = {1, 2, 3};
    CHECK(error_of([&] { scene.add_texture(encoded); }) == "texture 0 has 1 texels, not 2 x 1");
    encoded.channels = 2;
    CHECK(error_of([&] { scene.add_texture(encoded); }) ==
          "texture 0 has neither 1 nor 3 channels");
    encoded = {1, 2, {{0, 0, 0}}};
    encoded.channels = 1;
    encoded.texels8 = {1};
    CHECK(error_of([&] { scene.add_texture(encoded); }) == "texture 0 has texels of two kinds");
    Environment sky = constant_environment(1.0f);
    sky.map.texels.clear();
    sky.map.texels8 = {1, 2, 3};
    CHECK(error_of([&] { scene.set_environment(sky); }) == "environment: map is not of float3");
    CHECK(error_of([&] {
              scene.add_point_light({0, kNan, 0}, {1, 1, 1});
          }) == "point light 0: position is not finite");
    CHECK(error_of([&] {
              scene.add_point_light({0, 0, 0}, {1, -1, 1});
          }) == "point light 0: intensity is negative");
    CHECK(error_of([&] {
              scene.add_spot_light({}, {}, {1, 1, 1}, 0.1f, 0.2f);
          }) == "spot light 0: direction is 0");
    CHECK(error_of([&] {
              scene.add_spot_light({}, {1, 0, 0}, {1, 1, 1}, 0.3f, 0.2f);
          }) == "spot light 0: inner and outer are not 0 <= inner <= outer <= pi");
    CHECK(error_of([&] {
              scene.add_spot_light({0, kNan, 0}, {1, 0, 0}, {1, 1, 1}, 0.1f, 0.2f);
          }) == "spot light 0: position is not finite");
    CHECK(error_of([&] {
              scene.add_spot_light({}, {1, kNan, 0}, {1, 1, 1}, 0.1f, 0.2f);
          }) == "spot light 0: direction is not finite");
    for (const float3 intensity : {float3{-1, 1, 1}, float3{1, 1, -1}}) {
        CHECK(error_of([&] {
                  scene.add_spot_light({}, {1, 0, 0}, intensity, 0.1f, 0.2f);
              }) == "spot light 0: intensity is negative");
    }
    const auto environment_error = [&](float3 texel, float3 scale, float rotation) {
        return error_of([&] { scene.set_environment({{1, 1, {texel}}, scale, rotation}); });
    };
    CHECK(environment_error({1, -1, 1}, {1, 1, 1}, 0.0f) ==
          "environment: map: texels[0] is negative");
    CHECK(environment_error({1, 1, 1}, {1, 1, -1}, 0.0f) == "environment: scale is negative");
    CHECK(environment_error({1, 1, 1}, {1, 1, 1}, kNan) == "environment: rotation is not finite");
    CHECK(environment_error({1e30f, 1, 1}, {1e30f, 1, 1}, 0.0f) ==
          "environment: map times scale is not finite");

    CHECK(material_error([](Material& m) { m.base_color.y = 1.5f; }) ==
          "material 0: base_color.y is 1.500000, not in [0, 1]");
    for (const float3 color : {float3{1.5f, 0, 0}, float3{0, 0, 1.5f}}) {
        CHECK(material_error([&](Material& m) { m.base_color = color; }) ==
              std::string("material 0: base_color.") + (color.x > 0 ? "x" : "z") +
                  " is 1.500000, not in [0, 1]");
    }
    CHECK(material_error([](Material& m) { m.metallic = -1.0f; }) ==
          "material 0: metallic is -1.000000, not in [0, 1]");
    CHECK(material_error([](Material& m) { m.kind = static_cast<MaterialKind>(2); }) ==
          "material 0: kind is unknown");
    CHECK(material_error([](Material& m) { m.metallic_roughness_texture = 0; }) ==
          "material 0: metallic_roughness_texture is texture 0, which has a texel above 1");
    CHECK(material_error([](Material& m) { m.roughness = kNan; }) ==
          "material 0: roughness is nan, not in [0, 1]");
    CHECK(material_error([](Material& m) { m.base_color_texture = 1; }) ==
          "material 0: base_color_texture is 1, but there are 1 textures");
    CHECK(material_error([](Material& m) { m.base_color_texture = 0; }) ==
          "material 0: base_color_texture is texture 0, which has a texel above 1");

    CHECK(camera_error([](Camera& c) { c.orthographic_height = -1.0f; }) ==
          "camera: orthographic_height is negative");
    CHECK(camera_error([](Camera& c) { c.orthographic_height = c.aperture_radius = 1.0f; }) ==
          "camera: aperture_radius is above 0, and orthographic cameras have no lens");
    CHECK(camera_error([](Camera& c) { c.target = c.origin; }) == "camera: target is the origin");
    CHECK(camera_error([](Camera& c) {
              c.up = {0, 0, -3};
          }) == "camera: up is parallel to the direction of view");
    CHECK(camera_error([](Camera& c) { c.up = {0, 0, 0}; }) == "camera: up is 0");
    CHECK(camera_error([](Camera& c) { c.focus_distance = 2e15f; }) ==
          "camera: focus_distance is above 1e15");
    CHECK(camera_error([](Camera& c) { c.vertical_fov = 3.2f; }) ==
          "camera: vertical_fov is not in (0, pi)");
    CHECK(camera_error([](Camera& c) { c.aperture_radius = kNan; }) ==
          "camera: aperture_radius is not finite");
    CHECK(camera_error([](Camera& c) { c.aperture_radius = -1.0f; }) ==
          "camera: aperture_radius is negative");
    CHECK(camera_error([](Camera& c) { c.focus_distance = 0.0f; }) ==
          "camera: focus_distance is not above 0");
}

TEST_CASE("a committed scene takes no more, and one that is not cannot be rendered") {
    auto scene = std::make_shared<Scene>();
    const RenderSettings settings;
    CHECK(error_of([&] { Renderer(scene, settings, make_sampler(UniformOptions{}, {})); }) ==
          "scene: commit() must come before rendering");
    CHECK(error_of([&] { camera_points(*scene, settings, 9); }) ==
          "scene: commit() must come before rendering");
    scene->commit();
    const std::string refused = "scene: nothing can be changed after commit()";
    CHECK(error_of([&] { scene->add_material({}); }) == refused);
    CHECK(error_of([&] { scene->add_mesh({}); }) == refused);
    CHECK(error_of([&] { scene->set_camera({}); }) == refused);
    CHECK(error_of([&] { scene->set_environment(constant_environment(1.0f)); }) == refused);
    CHECK(error_of([&] { scene->add_texture({}); }) == refused);
    CHECK(error_of([&] { scene->add_point_light({}, {}); }) == refused);
    CHECK(error_of([&] { scene->add_spot_light({}, {1, 0, 0}, {}, 0.1f, 0.2f); }) == refused);
    CHECK(error_of([&] { scene->commit(); }) == refused);
    CHECK(error_of([&] { Renderer(nullptr, settings, make_sampler(UniformOptions{}, {})); }) ==
          "renderer: there is no scene");
    CHECK(error_of([&] { Renderer(scene, settings, nullptr); }) == "renderer: there is no sampler");
    RenderSettings wrong;
    wrong.height = 0;
    CHECK(error_of([&] { Renderer(scene, wrong, make_sampler(UniformOptions{}, {})); }) ==
          "settings: height is not in [1, 65535]");
    wrong = {};
    wrong.max_depth = 0;
    CHECK(error_of([&] { Renderer(scene, wrong, make_sampler(UniformOptions{}, {})); }) ==
          "settings: max_depth is 0: no path has no edge");
}

TEST_CASE("the lights are the emissive triangles, points and spots, in the order of adding") {
    Scene scene;
    Texture half{2, 1, {{0, 0, 0}, {1, 1, 1}}};
    scene.add_texture(half);
    scene.add_material(diffuse(0.5f));
    const Shape square = unit_square();
    scene.add_mesh(square.mesh("dark", 0));
    scene.add_point_light({1, 2, 3}, {4, 4, 4});
    const std::vector<float3> faces{{0, 0, 0}, {0.5f, 0.5f, 0.5f}};
    Emission e = emission(6.0f);
    e.face_radiance = faces;
    scene.add_mesh(square.mesh("one of two", 0, e));
    scene.add_spot_light({3, 2, 1}, {0, -2, 0}, {5, 5, 5}, 0.2f, 0.4f);
    const std::vector<float2> uvs{{0.6f, 0}, {0.9f, 0}, {0.9f, 1}, {0.6f, 1}};
    Emission textured = emission(2.0f);
    textured.texture = 0;
    Mesh mesh = square.mesh("textured", 0, textured);
    mesh.uvs = uvs;
    scene.add_mesh(mesh);
    scene.commit();

    const Span<const Light> lights = scene.lights();
    REQUIRE(lights.size() == 5);
    CHECK(scene.triangle_count() == 6);
    CHECK_FALSE(scene.has_environment());
    CHECK(lights[0].intensity == doctest::Approx(4));
    CHECK(lights[0].center.z == 3.0f);
    CHECK(lights[1].intensity == doctest::Approx(3.0 * 0.5));
    CHECK(lights[1].axis.z == doctest::Approx(1));
    CHECK_FALSE(lights[1].two_sided);
    CHECK(lights[2].intensity == doctest::Approx(5));
    CHECK(lights[2].axis.y == doctest::Approx(-1));
    // The texture rises from 0.7 to 1 half-way across and falls again.
    CHECK(lights[3].intensity + lights[4].intensity ==
          doctest::Approx(1.7).scale(0.0).epsilon(0.01));
}
