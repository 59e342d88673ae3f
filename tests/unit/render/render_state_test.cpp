#include <doctest/doctest.h>

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <lightcull/error.h>

#include "unit/render/render_support.h"

/// These tests show that renderers go on from the state of another.

using namespace render_support;

namespace {

/// A floor below lamps of half a metre.
std::shared_ptr<const Scene> room(int lamps = 1) {
    auto scene = std::make_shared<Scene>();
    const MaterialId grey = scene->add_material({});
    Shape floor, lamp;
    floor.add_level_square({0, 0, 0}, 3.0f, true);
    for (int i = 0; i < lamps; ++i) {
        lamp.add_level_square({0.0f, 2.0f, -1.5f * static_cast<float>(i)}, 0.5f, false);
    }
    Mesh mesh;
    mesh.name = "floor";
    mesh.positions = floor.positions;
    mesh.indices = floor.indices;
    mesh.material = grey;
    scene->add_mesh(mesh);
    mesh.name = "lamp";
    mesh.positions = lamp.positions;
    mesh.indices = lamp.indices;
    mesh.emission.radiance = {4, 5, 6};
    scene->add_mesh(mesh);
    Camera camera;
    camera.origin = {0, 1, 4};
    camera.target = {0, 0.5f, 0};
    scene->set_camera(camera);
    scene->commit();
    return scene;
}

RenderSettings settings() {
    RenderSettings s;
    s.width = 20;
    s.height = 12;
    s.max_depth = 3;
    s.seed = 7;
    return s;
}

Renderer make_renderer(const std::shared_ptr<const Scene>& scene) {
    return {scene, settings(), make_scene_sampler("culled", *scene, settings())};
}

bool same(const std::vector<float3>& a, const std::vector<float3>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i].x != b[i].x || a[i].y != b[i].y || a[i].z != b[i].z) return false;
    }
    return true;
}

}  // namespace

TEST_CASE("a renderer goes on from the state of another with the same bits") {
    const auto scene = room();
    Renderer first = make_renderer(scene), second = make_renderer(scene);
    for (int pass = 0; pass < 3; ++pass) first.render_pass();
    second.restore(first.state());
    CHECK(same(second.image(), first.image()));
    CHECK(second.stats().passes == 3);
    CHECK(second.stats().rays == first.stats().rays);
    for (int pass = 0; pass < 2; ++pass) {
        first.render_pass();
        second.render_pass();
    }
    CHECK(second.stats().passes == 5);
    CHECK(same(second.image(), first.image()));
}

TEST_CASE("parts of an image have the bits of its passes, whoever renders them, in any order") {
    const auto scene = room(20);
    RenderSettings apart = settings();
    apart.emission_apart = true;
    const std::string description = "learned:rounds=4";
    const auto make = [&] {
        return std::make_unique<Renderer>(scene, apart,
                                          make_scene_sampler(description, *scene, apart));
    };
    const auto teacher = make(), pupil = make();
    for (int pass = 0; pass < 4; ++pass) {
        CHECK(teacher->learning());
        teacher->render_pass();
    }
    CHECK_FALSE(teacher->learning());
    const std::vector<std::uint8_t> learned = teacher->sampler().learned();
    CHECK(pupil->learning());

    std::vector<std::vector<double>> sums, emission;
    for (std::uint64_t pass = 4; pass < 7; ++pass) {
        teacher->begin_part(pass);
        CHECK(teacher->stats().passes == pass);
        teacher->render_pass();
        CHECK(teacher->stats().passes == pass + 1);
        sums.push_back(teacher->state().sums);
        emission.push_back(teacher->emission_sums());
    }
    CHECK(sums[0] != sums[1]);
    CHECK(emission[0] != emission[1]);
    pupil->begin_part(6, learned);
    CHECK_FALSE(pupil->learning());
    for (const std::size_t part : {2u, 0u, 1u}) {
        pupil->begin_part(4 + part);
        pupil->render_pass();
        CHECK(pupil->state().sums == sums[part]);
        CHECK(pupil->emission_sums() == emission[part]);
    }
    // One that knows nothing chooses other lights.
    const auto fresh = make();
    fresh->begin_part(4);
    fresh->render_pass();
    CHECK(fresh->state().sums != sums[0]);
    CHECK(fresh->emission_sums() == emission[0]);
}

TEST_CASE("a renderer whose sampler does not learn does not either") {
    const auto scene = room();
    const Renderer renderer = make_renderer(scene);
    CHECK_FALSE(renderer.learning());
    CHECK(renderer.emission_sums().empty());
}

TEST_CASE("a state of another image, or none at all, is refused by name") {
    const auto scene = room();
    Renderer renderer = make_renderer(scene);
    renderer.render_pass();
    const std::vector<float3> before = renderer.image();

    RenderState state = renderer.state();
    state.sums.pop_back();
    CHECK_THROWS_WITH_AS(renderer.restore(state), "state: has 719 sums, not 720", Error);
    state = renderer.state();
    state.sums[5] = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH_AS(renderer.restore(state), "state: sums[5] is not finite", Error);
    state = renderer.state();
    state.stats.seconds = -1.0;
    CHECK_THROWS_WITH_AS(renderer.restore(state),
                         "state: a number of seconds is negative or not finite", Error);
    CHECK(same(renderer.image(), before));
}

TEST_CASE("emission that is kept apart is what paths of one edge find, to the bit") {
    const auto scene = room();
    RenderSettings apart = settings();
    apart.emission_apart = true;
    apart.max_depth = 1;
    const auto render = [&](const RenderSettings& s) {
        auto renderer =
            std::make_unique<Renderer>(scene, s, make_scene_sampler("culled", *scene, s));
        for (int pass = 0; pass < 3; ++pass) renderer->render_pass();
        return renderer;
    };
    const auto seen = render(apart);
    apart.max_depth = 3;
    const auto whole = render(apart), plain = render(settings());
    CHECK(same(whole->emission(), seen->image()));
    CHECK(same(whole->image(), plain->image()));
    const std::vector<float3> image = whole->image(), emission = whole->emission(),
                              lit = whole->lit();
    REQUIRE(lit.size() == image.size());
    bool is_lit = false, is_seen = false;
    for (std::size_t i = 0; i < image.size(); ++i) {
        CHECK(lit[i].x + emission[i].x == doctest::Approx(image[i].x));
        is_lit = is_lit || lit[i].x > 0.0f;
        is_seen = is_seen || emission[i].x > 0.0f;
    }
    CHECK(is_lit);
    CHECK(is_seen);
    CHECK(plain->emission().empty());
    CHECK(plain->lit().empty());
    CHECK_THROWS_WITH_AS(whole->restore(plain->state()),
                         "renderer: keeps emission apart, of which a state knows nothing", Error);
}

TEST_CASE("positions that are too far out are refused by name") {
    Scene scene;
    CHECK_THROWS_WITH_AS(scene.add_point_light({2e15f, 0, 0}, {1, 1, 1}),
                         "point light 0: position is above 1e15", Error);
    CHECK_THROWS_WITH_AS(scene.add_spot_light({0, -2e15f, 0}, {1, 0, 0}, {1, 1, 1}, 0.1f, 0.2f),
                         "spot light 0: position is above 1e15", Error);
    Camera camera;
    camera.target = {0, 0, 2e15f};
    CHECK_THROWS_WITH_AS(scene.set_camera(camera), "camera: target is above 1e15", Error);
    camera = {};
    camera.aperture_radius = 2e15f;
    CHECK_THROWS_WITH_AS(scene.set_camera(camera), "camera: aperture_radius is above 1e15", Error);
}

TEST_CASE("directions of any length are taken") {
    for (const float length : {1e-30f, 1.0f, 1e30f}) {
        CAPTURE(length);
        Scene scene;
        scene.add_spot_light({0, 0, 0}, {0, length, 0}, {1, 1, 1}, 0.1f, 0.2f);
        CHECK(scene.lights()[0].axis.y == doctest::Approx(1.0));
        Camera camera;
        camera.up = {0, length, 0};
        scene.set_camera(camera);
    }
}
