#include "unit/render/render_support.h"

#include <doctest/doctest.h>

#include <cmath>
#include <optional>
#include <vector>

using namespace render_support;

namespace {

/// A floor under two squares of light, one right above the other, seen from above by parallel rays.
std::shared_ptr<const Scene> floor_under_lamps(float camera_height) {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape floor, lamps;
    floor.add_level_square({0, 0, 0}, 2.0f, true);
    lamps.add_level_square({0.1f, 2, 0}, 0.5f, false);
    lamps.add_level_square({0, 2.25f, 0.1f}, 0.5f, true);
    scene->add_mesh(floor.mesh("floor", 0));
    scene->add_mesh(lamps.mesh("lamps", 0, emission(3.0f)));
    scene->set_environment(constant_environment(0.25f));
    Camera camera = look({0, camera_height, 0}, {0, 0, 0}, 0.8f, {1, 0, 0});
    camera.orthographic_height = 5.0f;
    scene->set_camera(camera);
    return committed(scene);
}

RenderSettings hidden(std::uint32_t max_depth) {
    RenderSettings settings = square_image(20, max_depth);
    settings.hide_emitters = true;
    return settings;
}

std::vector<float3> one_pass(const std::shared_ptr<const Scene>& scene,
                             const RenderSettings& settings) {
    Renderer renderer(scene, settings, make_scene_sampler("uniform", *scene, settings));
    renderer.render_pass();
    return renderer.image();
}

}  // namespace

TEST_CASE("behind hidden emitters the camera sees what it would see without them") {
    const auto through = one_pass(floor_under_lamps(5.0f), hidden(3));
    const auto from_below = one_pass(floor_under_lamps(1.0f), hidden(3));
    const auto shown = one_pass(floor_under_lamps(5.0f), square_image(20, 3));
    double lamps = 0.0;
    for (std::size_t i = 0; i < through.size(); ++i) {
        CHECK(through[i].x == doctest::Approx(from_below[i].x).epsilon(1e-3));
        lamps += std::fabs(double{shown[i].x} - double{through[i].x});
    }
    CHECK(lamps > 10.0);
}

TEST_CASE("a hidden environment is black to the camera, and lights what it sees") {
    const auto scene = floor_under_lamps(5.0f);
    const auto image = one_pass(scene, hidden(2));
    CHECK(image[0].x == 0.0f);  // The floor is not as large as the picture.
    CHECK(image[20 * 10 + 10].x > 0.0f);
    CHECK(one_pass(scene, square_image(20, 2))[0].x == 0.25f);
    for (const float3 pixel : one_pass(scene, hidden(1))) CHECK(pixel.x == 0.0f);
}

TEST_CASE("mirrors show what is hidden from the camera") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(metal(0.0f));
    Shape mirror;
    mirror.add_level_square({0, 0, 0}, 5.0f, true);
    scene->add_mesh(mirror.mesh("mirror", 0));
    scene->set_environment(constant_environment(1.0f));
    scene->set_camera(look({0, 3, 0}, {0, 0, 0}, 0.5f, {1, 0, 0}));
    const double mean = render_mean(committed(scene), hidden(2), "uniform", 4).mean;
    CHECK(mean == doctest::Approx(1.0).epsilon(0.02));
}

TEST_CASE("a renderer keeps no part of the image for emission that is hidden") {
    const auto scene = floor_under_lamps(5.0f);
    RenderSettings settings = hidden(2);
    settings.emission_apart = true;
    Renderer renderer(scene, settings, make_scene_sampler("uniform", *scene, settings));
    renderer.render_pass();
    for (const float3 pixel : renderer.emission()) CHECK(pixel.x == 0.0f);
}

TEST_CASE("points that the camera sees are not on hidden emitters") {
    const auto scene = floor_under_lamps(5.0f);
    for (const ShadingPoint& point : camera_points(*scene, hidden(2), 400)) {
        CHECK(point.position.y == doctest::Approx(0.0f));
    }
    for (const std::optional<ShadingPoint>& point : pixel_points(*scene, hidden(2))) {
        if (point) CHECK(point->position.y == doctest::Approx(0.0f));
    }
}
