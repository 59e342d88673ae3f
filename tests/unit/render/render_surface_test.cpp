#include "render/scene_data.h"
#include "render/surface.h"
#include "unit/render/render_support.h"

#include <doctest/doctest.h>

#include <vector>

using namespace render_support;
using lightcull::Bsdf;
using lightcull::Hit;
using lightcull::make_surface;
using lightcull::Surface;
using lightcull::to_v3f;
using lightcull::V3f;

namespace {

/// One triangle in the plane z = 0, facing +Z, with what the function adds.
template <typename Add>
void add_triangle(Scene& scene, const Add& add) {
    const std::vector<float3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<std::uint32_t> indices{0, 1, 2};
    const std::vector<float2> uvs{{0.25f, 0.5f}, {0.75f, 0.5f}, {0.25f, 0.5f}};
    Mesh mesh;
    mesh.name = "triangle";
    mesh.positions = positions;
    mesh.indices = indices;
    mesh.uvs = uvs;
    add(mesh);
    scene.add_mesh(mesh);
}

const Hit kHit{0, 0.25f, 0.5f};

}  // namespace

TEST_CASE("a surface is where its barycentric coordinates say and faces the viewer") {
    Scene scene;
    scene.add_material(diffuse(0.5f));
    add_triangle(scene, [](Mesh&) {});
    for (const float side : {1.0f, -1.0f}) {
        const Surface s = make_surface(data_of(scene), kHit, unit(V3f(0.3f, 0.1f, -side)));
        CHECK((s.position - V3f(0.25f, 0.5f, 0.0f)).length() < 1e-6f);
        CHECK(s.normal == V3f(0, 0, side));
        CHECK(s.bsdf.normal() == V3f(0, 0, side));
        CHECK(s.origin.z * side > 0.0f);
        CHECK(s.origin.z * side < 1e-4f);
        const ShadingPoint point = s.shading_point(3);
        CHECK(point.normal.z == side);
        CHECK(point.set == 3);
    }
}

TEST_CASE("shading normals are interpolated, on the viewer's side, and bent towards the viewer") {
    Scene scene;
    scene.add_material(diffuse(0.5f));
    const std::vector<float3> normals{{1, 0, 1}, {0, 0, 2}, {0, 0, 1}};
    add_triangle(scene, [&](Mesh& m) { m.normals = normals; });
    const V3f smooth = unit(V3f(0.25f, 0.0f, 0.25f + 0.5f + 0.5f));
    const V3f front = make_surface(data_of(scene), kHit, V3f(0, 0, -1)).bsdf.normal();
    CHECK((front - smooth).length() < 1e-6f);
    const V3f back = make_surface(data_of(scene), kHit, V3f(0, 0, 1)).bsdf.normal();
    CHECK((back + smooth).length() < 1e-6f);
    // The viewer is above the triangle, but behind the smooth surface.
    const V3f outgoing = unit(V3f(-1.0f, 0.0f, 0.1f));
    REQUIRE(smooth.dot(outgoing) < 0.0f);
    const Surface grazing = make_surface(data_of(scene), kHit, -outgoing);
    CHECK(grazing.bsdf.normal().dot(outgoing) > 0.0f);
    CHECK(grazing.bsdf.normal().length() == doctest::Approx(1.0));
    CHECK(grazing.normal == V3f(0, 0, 1));

    Scene flat;
    flat.add_material(diffuse(0.5f));
    const std::vector<float3> none(3);
    add_triangle(flat, [&](Mesh& m) { m.normals = none; });
    CHECK(make_surface(data_of(flat), kHit, V3f(0, 0, -1)).bsdf.normal() == V3f(0, 0, 1));
}

TEST_CASE("textures multiply base colour, roughness (green) and metallic (blue)") {
    // At the hit u is 0.375: a quarter of the way from the first texel to the second.
    Scene scene;
    scene.add_texture({2, 1, {{0.2f, 0.4f, 0.6f}, {1.0f, 0.8f, 0.2f}}});
    Material textured;
    textured.base_color = {0.5f, 1.0f, 1.0f};
    textured.base_color_texture = 0;
    scene.add_material(textured);
    add_triangle(scene, [](Mesh&) {});
    textured.kind = MaterialKind::kMetallicRoughness;
    textured.metallic = 0.9f;
    textured.roughness = 0.8f;
    textured.metallic_roughness_texture = 0;
    scene.add_material(textured);
    add_triangle(scene, [](Mesh& m) { m.material = 1; });

    const V3f base_color(0.5f * 0.4f, 0.5f, 0.5f), normal(0, 0, 1);
    const V3f outgoing = unit(V3f(0.5f, 0.2f, 1.0f)), incoming = unit(V3f(-0.3f, 0.1f, 1.0f));
    const Surface matte = make_surface(data_of(scene), kHit, -outgoing);
    const V3f expected = Bsdf::diffuse(normal, outgoing, base_color).evaluate(incoming).value;
    CHECK((matte.bsdf.evaluate(incoming).value - expected).length() < 1e-5f);

    const Surface shiny = make_surface(data_of(scene), {1, 0.25f, 0.5f}, -outgoing);
    const V3f expected_shiny =
        Bsdf::metallic_roughness(normal, outgoing, base_color, 0.9f * 0.5f, 0.8f * 0.5f)
            .evaluate(incoming)
            .value;
    CHECK((shiny.bsdf.evaluate(incoming).value - expected_shiny).length() < 1e-5f);
}

TEST_CASE("light does not leak round a smooth normal") {
    // The shading normal sees the lamp under the floor, the floor does not.
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(1.0f));
    Shape floor, lamp;
    floor.add_level_square({0, 0, 0}, 1.0f, true);
    lamp.add_quad({5, -3, -3}, {5, -3, 3}, {5, -0.5f, 3}, {5, -0.5f, -3});
    const std::vector<float3> tilted(4, {1, 0.2f, 0});
    Mesh mesh = floor.mesh("floor", 0);
    mesh.normals = tilted;
    scene->add_mesh(mesh);
    scene->add_mesh(lamp.mesh("lamp", 0, emission(10.0f)));
    scene->set_camera(look({1, 3, 0}, {0, 0, 0}, 0.3f));
    scene->commit();
    for (const auto technique : {DirectLight::kLights, DirectLight::kBsdf, DirectLight::kMis}) {
        RenderSettings settings = square_image(16, 2);
        settings.direct_light = technique;
        CHECK(render_mean(scene, settings, "power", 16).mean == 0.0);
    }
}

TEST_CASE("a textured lamp lights by light sampling as by BSDF sampling") {
    auto scene = std::make_shared<Scene>();
    scene->add_texture({4, 1, {{0, 0, 0}, {0, 0, 0}, {1, 0.5f, 0}, {0, 0, 0.2f}}});
    scene->add_material(diffuse(0.7f));
    Shape floor, lamp;
    floor.add_level_square({0, 0, 0}, 2.0f, true);
    lamp.add_level_square({0, 1.5f, 0}, 1.5f, false);
    const std::vector<float2> uvs{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    Emission e = emission(2.0f);
    e.texture = 0;
    Mesh mesh = lamp.mesh("lamp", 0, e);
    mesh.uvs = uvs;
    scene->add_mesh(floor.mesh("floor", 0));
    scene->add_mesh(mesh);
    scene->set_camera(look({0, 1, 5}, {0, -0.2f, 0}, 0.4f));
    scene->commit();
    RenderSettings settings = square_image(32, 2);
    std::vector<std::vector<statistics::Estimate>> images;
    for (const auto technique : {DirectLight::kLights, DirectLight::kBsdf, DirectLight::kMis}) {
        settings.direct_light = technique;
        ++settings.seed;
        images.push_back(
            render_blocks(scene, settings, make_sampler(PowerOptions{}, scene->lights()), 500, 8));
        CHECK(std::sqrt(images.back().back().variance) < 0.01 * images.back().back().mean);
    }
    CHECK(statistics::worst_p(images[0], images[1]) > statistics::least_p());
    CHECK(statistics::worst_p(images[0], images[2]) > statistics::least_p());
}
