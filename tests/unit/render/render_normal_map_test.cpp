#include "unit/render/render_support.h"

#include <lightcull/error.h>

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

using namespace render_support;

namespace {

/// A texture of one normal, tilted by radians about the axis that stands to the left of (x, y).
Texture tilted(double angle, double x, double y) {
    const double length = std::hypot(x, y), sine = std::sin(angle) / length;
    const auto number = [](double c) { return static_cast<float>(0.5 + 0.5 * c); };
    return {1, 1, {{number(x * sine), number(y * sine), number(std::cos(angle))}}};
}

struct Square {
    std::vector<float3> positions{{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}};
    std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
    std::vector<float2> uvs{{0, 0}, {1, 0}, {1, 1}, {0, 1}};  ///< u along +X, v along -Z
    std::vector<float3> normals;

    Mesh mesh() const {
        Mesh m;
        m.name = "square";
        m.positions = positions;
        m.indices = indices;
        m.uvs = uvs;
        m.normals = normals;
        return m;
    }
};

/// What the camera sees of a square with a normal map, above it or below, in the light of a sun.
float seen(const Square& square, const Texture& map, float scale, float3 towards_sun,
           bool from_below = false, Material material = diffuse(0.8f)) {
    auto scene = std::make_shared<Scene>();
    material.normal_texture = scene->add_texture(map);
    material.normal_scale = scale;
    scene->add_material(material);
    scene->add_mesh(square.mesh());
    scene->add_directional_light({-towards_sun.x, -towards_sun.y, -towards_sun.z}, {1, 1, 1});
    scene->set_camera(look({0, from_below ? -3.0f : 3.0f, 0}, {0, 0, 0}, 0.1f, {1, 0, 0}));
    const RenderSettings settings = square_image(4, 2);
    const auto ready = committed(scene);
    Renderer renderer(ready, settings, make_scene_sampler("uniform", *ready, settings));
    renderer.render_pass();
    return renderer.image()[5].x;
}

float3 from_zenith(double angle, double x, double z) {
    const auto number = [](double c) { return static_cast<float>(c); };
    return {number(x * std::sin(angle)), number(std::cos(angle)), number(z * std::sin(angle))};
}

constexpr double kTilt = 0.4, kSun = 0.6;

double reflected(double angle) {
    return 0.8 / kPi * std::cos(angle);
}

}  // namespace

TEST_CASE("a constant tilted normal map shades as a tilted plane") {
    const Square square;
    const Texture to_u = tilted(kTilt, 1, 0), to_v = tilted(kTilt, 0, 1);
    const auto near = [](double value) { return doctest::Approx(value).epsilon(1e-4); };
    CHECK(seen(square, to_u, 1.0f, from_zenith(kSun, 1, 0)) == near(reflected(kSun - kTilt)));
    CHECK(seen(square, to_u, 1.0f, from_zenith(kSun, -1, 0)) == near(reflected(kSun + kTilt)));
    CHECK(seen(square, to_v, 1.0f, from_zenith(kSun, 0, -1)) == near(reflected(kSun - kTilt)));
    CHECK(seen(square, to_v, 1.0f, from_zenith(kSun, 0, 1)) == near(reflected(kSun + kTilt)));
    CHECK(seen(square, to_u, 0.0f, from_zenith(kSun, 1, 0)) == near(reflected(kSun)));
    const double halved = std::atan(0.5 * std::tan(kTilt));
    CHECK(seen(square, to_u, 0.5f, from_zenith(kSun, 1, 0)) == near(reflected(kSun - halved)));
    CHECK(seen(square, to_u, -0.5f, from_zenith(kSun, 1, 0)) == near(reflected(kSun + halved)));
}

TEST_CASE("a normal map follows its texture coordinates, and the normals of the mesh") {
    const auto near = [](double value) { return doctest::Approx(value).epsilon(1e-4); };
    const Texture to_u = tilted(kTilt, 1, 0), to_v = tilted(kTilt, 0, 1);
    Square mirrored;  // u along -X, v along -Z
    mirrored.uvs = {{1, 0}, {0, 0}, {0, 1}, {1, 1}};
    CHECK(seen(mirrored, to_u, 1.0f, from_zenith(kSun, -1, 0)) == near(reflected(kSun - kTilt)));
    CHECK(seen(mirrored, to_v, 1.0f, from_zenith(kSun, 0, -1)) == near(reflected(kSun - kTilt)));
    Square bent;  // The normals lean by as much as the map again.
    bent.normals.assign(4, from_zenith(kTilt, 1, 0));
    CHECK(seen(bent, to_u, 1.0f, from_zenith(kSun, 1, 0)) == near(reflected(kSun - 2.0 * kTilt)));
    Square pointless;
    pointless.uvs.assign(4, {0.5f, 0.5f});
    CHECK(seen(pointless, tilted(0, 1, 0), 1.0f, from_zenith(kSun, 1, 0)) == near(reflected(kSun)));
}

TEST_CASE("from the back a normal map is seen from behind") {
    const Square square;
    const Texture to_u = tilted(kTilt, 1, 0);
    // The back's normal is the front's, turned round: it leans to -X.
    const float3 sun = {-std::sin(0.6f), -std::cos(0.6f), 0.0f};
    CHECK(seen(square, to_u, 1.0f, sun, true) ==
          doctest::Approx(reflected(kSun - kTilt)).epsilon(1e-4));
}

TEST_CASE("a polished surface with a steep normal map is not black at grazing angles") {
    for (const float x : {-3.0f, 3.0f}) {
        auto scene = std::make_shared<Scene>();
        Material polished = metal(0.05f);
        polished.normal_texture = scene->add_texture(tilted(1.0, 1, 0));
        scene->add_material(polished);
        scene->add_mesh(Square{}.mesh());
        scene->set_environment(constant_environment(1.0f));
        scene->set_camera(look({x, 0.6f, 0}, {0, 0, 0}, 0.05f));
        CHECK(render_mean(committed(scene), square_image(4, 2), "uniform", 16).mean > 0.5);
    }
}

TEST_CASE("a normal map must be a texture, of a mesh that has texture coordinates") {
    Scene scene;
    Material material;
    material.normal_texture = 0;
    CHECK_THROWS_WITH_AS(scene.add_material(material),
                         "material 0: normal_texture is 0, but there are 0 textures", Error);
    material.normal_texture = scene.add_texture(tilted(0.1, 1, 0));
    scene.add_material(material);
    Square square;
    square.uvs.clear();
    CHECK_THROWS_AS(scene.add_mesh(square.mesh()), Error);
    material.normal_scale = std::nanf("");
    CHECK_THROWS_AS(scene.add_material(material), Error);
}
