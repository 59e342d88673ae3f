#include "unit/render/render_support.h"

#include <doctest/doctest.h>
#include <lightcull/error.h>
#include <lightcull/render/preview.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

using namespace render_support;

namespace {

/// A grey square of side 4 at y = 0 that faces up, with a texture if asked for, in white
/// surroundings; a square lamp of side 1 at y = 1 that faces down, of radiance 3.
void fill(Scene& scene, bool textured = false) {
    Material grey = diffuse(1.0f);
    const TextureId texture = scene.add_texture({1, 1, {{0.9f, 0.9f, 0.9f}}});
    if (textured) grey.base_color_texture = texture;
    const std::vector<float2> uvs(4);
    Shape floor, lamp;
    floor.add_level_square({0, 0, 0}, 2.0f, true);
    lamp.add_level_square({0, 1, 0}, 0.5f, false);
    Mesh mesh = floor.mesh("floor", scene.add_material(grey));
    mesh.uvs = uvs;
    scene.add_mesh(mesh);
    Emission emission;
    emission.radiance = {3, 3, 3};
    scene.add_mesh(lamp.mesh("lamp", scene.add_material(diffuse(0.0f)), emission));
}

float mean_seen(const std::vector<float3>& pixels) {
    double sum = 0.0;
    int count = 0;
    for (const float3& p : pixels) {
        if (std::isnan(p.x)) continue;
        sum += static_cast<double>(p.x);
        ++count;
    }
    return static_cast<float>(sum / count);
}

}  // namespace

TEST_CASE("a preview tells distances, infinite where nothing is met, negative where it is a back") {
    Scene scene;
    fill(scene);
    const Preview preview(scene);
    const std::vector<float3> origins{{1, 3, 0}, {1, 3, 0}, {1, -3, 0}, {0, 3, 0}};
    const std::vector<float3> directions{{0, -1, 0}, {0, 1, 0}, {0, 2, 0}, {0, -1, 0}};
    const std::vector<float> found = preview.distances(origins, directions);
    CHECK(found[0] == doctest::Approx(3.0));
    CHECK(std::isinf(found[1]));
    CHECK(found[2] == doctest::Approx(-1.5));
    CHECK(found[3] == doctest::Approx(-2.0));
}

TEST_CASE("a preview shows the scene as it will be rendered, and leaves it open") {
    Scene scene;
    fill(scene);
    Preview preview(scene);
    Camera camera = look({0, 2, 8}, {0, 0, 0}, 0.5f);
    scene.set_camera(camera);  // it is not closed
    const std::vector<float3> shown = preview.look(camera, 32, 24, 16);
    auto shared = std::make_shared<Scene>();
    fill(*shared);
    shared->set_camera(camera);
    shared->commit();
    RenderSettings settings;
    settings.width = 32;
    settings.height = 24;
    Renderer renderer(shared, settings, make_scene_sampler("light_bvh", *shared, settings));
    for (int pass = 0; pass < 16; ++pass) renderer.render_pass();
    const std::vector<float3> expected = renderer.image();
    const auto seen = pixel_points(*shared, settings);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        CHECK(std::isnan(shown[i].x) == !seen[i]);
        if (seen[i]) CHECK(shown[i].x == expected[i].x);
    }
    scene.commit();
    CHECK_THROWS_AS(Preview{scene}, Error);
}

TEST_CASE("what reflects is grey of a half in a preview where it has a texture") {
    Scene plain, textured;
    fill(plain);
    fill(textured, true);
    const Camera camera = look({0, 2, 8}, {0, 0, 0}, 0.2f);
    const float white = mean_seen(Preview(plain).look(camera, 16, 12, 64));
    const float grey = mean_seen(Preview(textured).look(camera, 16, 12, 64));
    CHECK(grey == doctest::Approx(0.5f * white).epsilon(0.001));
}

TEST_CASE("rays go through what is cut out in a preview, too") {
    Scene scene;
    fill(scene);
    Texture mask;
    mask.width = 2;
    mask.height = 1;
    mask.channels = 1;
    mask.texels8 = {0, 255};
    Material material = diffuse(0.5f);
    material.opacity_texture = scene.add_texture(mask);
    material.opacity_threshold = 0.5f;
    Shape plate;
    plate.add_level_square({0, 2, 0}, 2.0f, true);
    // u is 0.25 and 0.75 in the middles of the texels.
    const std::vector<float2> left(4, {0.25f, 0.5f}), right(4, {0.75f, 0.5f});
    Mesh mesh = plate.mesh("clear", scene.add_material(material));
    mesh.uvs = left;
    scene.add_mesh(mesh);
    const std::vector<float3> origin{{1, 3, 0}}, down{{0, -1, 0}};
    CHECK(Preview(scene).distances(origin, down)[0] == doctest::Approx(3.0));
    mesh.uvs = right;
    scene.add_mesh(mesh);
    CHECK(Preview(scene).distances(origin, down)[0] == doctest::Approx(1.0));
}

TEST_CASE("colours of vertices are seen in a preview") {
    Scene scene;
    fill(scene);
    Shape floor;
    floor.add_level_square({0, 0.001f, 0}, 2.0f, true);
    Mesh mesh = floor.mesh("carpet", scene.add_material(diffuse(1.0f)));
    const std::vector<float3> colors(4, {0.25f, 0.25f, 0.25f});
    mesh.colors = colors;
    scene.add_mesh(mesh);
    Scene plain;
    fill(plain);
    const Camera camera = look({0, 2, 8}, {0, 0, 0}, 0.2f);
    const float white = mean_seen(Preview(plain).look(camera, 16, 12, 64));
    const float dark = mean_seen(Preview(scene).look(camera, 16, 12, 64));
    CHECK(dark == doctest::Approx(0.25f * white).epsilon(0.005));
}

TEST_CASE("a preview shares the triangles of its scene, and each goes its own way from then on") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape ball;
    ball.add_sphere({0, 0, 0}, 1.0f, 64);
    const MeshId mesh = scene->add_mesh(ball.mesh("ball", 0));
    const std::size_t whole = scene->memory_size().data;
    const std::vector<float3> from{{0, 5, 0}, {3, 5, 0}}, down{{0, -1, 0}, {0, -1, 0}};
    {
        const Preview preview(*scene);
        CHECK(preview.memory_size().data < whole / 20);
        CHECK(preview.memory_size().bvh > 0);
        Shape beside;
        beside.add_level_square({3, 0, 0}, 1.0f, true);
        scene->add_mesh(beside.mesh("beside", 0));
        CHECK(scene->triangle_count() > 2);
        CHECK(std::isinf(preview.distances(from, down)[1]));
        CHECK(preview.memory_size().data > whole / 2);  // It has the only copy now.
    }
    scene->set_camera(look({0, 5, 0}, {0, 0, 0}, 0.1f, {1, 0, 0}));
    const Preview preview(*scene);
    CHECK(preview.distances(from, down)[1] == doctest::Approx(5.0));
    scene->commit();
    for (float3& p : ball.positions) p.x += 3.0f;
    scene->set_mesh_positions(mesh, ball.positions);
    scene->refit();
    CHECK(preview.distances(from, down)[0] == doctest::Approx(4.0));
    RenderSettings settings = square_image(3, 1);
    const std::optional<ShadingPoint> seen = pixel_points(*scene, settings)[4];
    CHECK(!seen);
}
