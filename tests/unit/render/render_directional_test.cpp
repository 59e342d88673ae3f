#include "unit/render/render_support.h"

#include <lightcull/error.h>
#include <lightcull/render/shadow_rays.h>
#include <lightcull/sampler_info.h>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

using namespace render_support;
using statistics::Estimate;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A floor at y = 0, and a camera that sees nothing but the origin, from the side.
std::shared_ptr<Scene> floor_scene(const Material& material) {
    auto scene = std::make_shared<Scene>();
    scene->add_material(material);
    Shape floor;
    floor.add_level_square({0, 0, 0}, 50.0f, true);
    scene->add_mesh(floor.mesh("floor", 0));
    scene->set_camera(look({0, 3.6f, 9.3f}, {0, 0, 0}, 1e-3f, {0, 0.3f, -1}));
    return scene;
}

/// The direction of light that comes from so far off the zenith, towards +x.
float3 from_zenith(float angle) {
    return {-std::sin(angle), -std::cos(angle), 0.0f};
}

double seen(const std::shared_ptr<Scene>& scene, const char* sampler = "uniform") {
    return render_mean(committed(scene), square_image(8, 2), sampler, 4).mean;
}

/// A floor seen from above, a plate over a part of it, lamps at one side, and suns, one of which
/// shines from below.
std::shared_ptr<Scene> court() {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.6f));
    Shape floor, plate;
    floor.add_level_square({0, 0, 0}, 4.0f, true);
    plate.add_level_square({0.5f, 1.0f, 0}, 1.0f, true);
    scene->add_mesh(floor.mesh("floor", 0));
    scene->add_mesh(plate.mesh("plate", 0));
    for (int i = 0; i < 12; ++i) {
        const int column = i % 4, row = i / 4;
        const auto x = static_cast<float>(column), z = static_cast<float>(row);
        scene->add_point_light({x - 2.0f, 0.5f + 0.1f * x, z - 2.0f}, {0.3f, 0.3f, 0.3f});
    }
    scene->add_directional_light(from_zenith(0.6f), {1.0f, 0.8f, 0.6f});
    scene->add_directional_light(from_zenith(-0.9f), {0.3f, 0.3f, 0.5f});
    scene->add_directional_light({0, 1, 0}, {5, 5, 5});
    scene->set_camera(look({0, 7, 0.01f}, {0, 0, 0}, 0.9f, {0, 0, -1}));
    return scene;
}

}  // namespace

TEST_CASE("a directional light gives a floor its irradiance by the cosine, from any distance") {
    for (const float angle : {0.0f, 0.7f, 1.5f}) {
        for (const char* sampler : {"uniform", "power", "light_bvh", "exhaustive", "culled",
                                    "learned", "paper", "clamped"}) {
            CAPTURE(angle);
            CAPTURE(sampler);
            auto scene = floor_scene(diffuse(0.5f));
            scene->add_directional_light(from_zenith(angle), {7, 7, 7});
            CHECK(seen(scene, sampler) ==
                  doctest::Approx(0.5 / kPi * 7.0 * std::cos(angle)).scale(0.0).epsilon(1e-5));
        }
    }
    auto below = floor_scene(diffuse(0.5f));
    below->add_directional_light({0.1f, 1, 0}, {7, 7, 7});
    CHECK(seen(below) == 0.0);
}

TEST_CASE("the shadow of a plate is sharp, and where the direction says, from a room to a planet") {
    for (const float size : {1e-3f, 1.0f, 1e5f}) {
        constexpr float kAngle = 0.7f, kHeight = 2.0f;
        const float across = kHeight * std::tan(kAngle);  // where the ray to the sun is up there
        const auto lit = [&](float center) {
            auto scene = std::make_shared<Scene>();
            scene->add_material(diffuse(0.5f));
            Shape floor, plate;
            floor.add_level_square({0, 0, 0}, 50.0f * size, true);
            plate.add_level_square({center * size, kHeight * size, 0}, size, true);
            scene->add_mesh(floor.mesh("floor", 0));
            scene->add_mesh(plate.mesh("plate", 0));
            scene->set_camera(look({0, 3.6f * size, 9.3f * size}, {0, 0, 0}, 1e-3f, {0, 0.3f, -1}));
            scene->add_directional_light(from_zenith(kAngle), {7, 7, 7});
            return seen(scene) / (0.5 / kPi * 7.0 * std::cos(kAngle));
        };
        CAPTURE(size);
        CHECK(lit(across - 1.02f) == doctest::Approx(1.0).epsilon(1e-4));
        CHECK(lit(across - 0.98f) == 0.0);
        CHECK(lit(across + 0.98f) == 0.0);
        CHECK(lit(across + 1.02f) == doctest::Approx(1.0).epsilon(1e-4));
    }
}

TEST_CASE("suns and lamps over glossy and matte floors: all samplers have one mean") {
    for (const Material& material : {diffuse(0.6f), gloss(0.4f)}) {
        const auto scene = [&] {
            auto made = court();
            made->add_material(material);
            Shape tile;
            tile.add_level_square({-1, 0.01f, 1}, 1.0f, true);
            made->add_mesh(tile.mesh("tile", 1));
            return committed(made);
        }();
        const RenderSettings settings = square_image(16, 3);
        const auto blocks = [&](const char* sampler) {
            return render_blocks(scene, settings, make_scene_sampler(sampler, *scene, settings),
                                 300, 4);
        };
        const std::vector<Estimate> truth = blocks("uniform");
        for (const char* sampler :
             {"power", "light_bvh", "light_bvh:importance=means", "exhaustive", "culled",
              "culled:accepted=2", "learned", "paper", "paper:test=light:list=0"}) {
            CAPTURE(sampler);
            CHECK(statistics::worst_p(blocks(sampler), truth) > statistics::least_p());
        }
    }
}

TEST_CASE("learned finds out where a sun is hidden") {
    const auto scene = committed(court());
    const RenderSettings settings = square_image(64, 2);
    Renderer renderer(scene, settings, make_scene_sampler("learned", *scene, settings));
    for (int pass = 0; pass < 12; ++pass) renderer.render_pass();
    const SamplerInfo* const info = sampler_info(renderer.sampler());
    REQUIRE(info != nullptr);
    constexpr std::uint32_t kSun = 12;
    REQUIRE(scene->lights()[kSun].directional);
    // The sun stands towards +x: the plate's shadow lies 0.68 m to the other side.
    const ShadingPoint hidden{{-0.9f, 0, 0}, {0, 1, 0}}, open{{-3, 0, 1}, {0, 1, 0}};
    CHECK(info->learned_visibility(hidden, kSun) < 0.1f);
    CHECK(info->learned_visibility(open, kSun) > 0.5f);
}

TEST_CASE("shadow rays to a directional light leave the scene") {
    const auto scene = committed(court());
    const std::vector<ShadingPoint> points{{{-0.2f, 0, 0}, {0, 1, 0}}, {{-3, 0, 1}, {0, 1, 0}}};
    const std::vector<Selection> selections(2, Selection{12, 1.0f, 1.0f, {}});
    std::vector<std::uint8_t> arrived(2);
    CHECK(ShadowRays(*scene, points, selections).trace(arrived) == 1);
    CHECK(arrived == std::vector<std::uint8_t>{0, 1});
}

TEST_CASE("a directional light that makes no sense is named by the scene") {
    Scene scene;
    scene.add_point_light({0, 0, 0}, {1, 1, 1});
    CHECK_THROWS_WITH_AS(scene.add_directional_light({0, 0, 0}, {1, 1, 1}),
                         "directional light 0: direction is 0", Error);
    CHECK_THROWS_AS(scene.add_directional_light({0, kInfinity, 0}, {1, 1, 1}), Error);
    CHECK_THROWS_AS(scene.add_directional_light({0, 1, 0}, {1, -1, 1}), Error);
    scene.add_directional_light({0, -3, 0}, {1, 1, 1});
    CHECK(scene.lights().size() == 2);
    CHECK(scene.lights()[1].directional);
    CHECK(scene.lights()[1].axis.y == -1.0f);
    CHECK(scene.lights()[1].intensity == doctest::Approx(1.0f));
}
