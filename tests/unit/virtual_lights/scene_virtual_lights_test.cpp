#include "unit/render/render_support.h"
#include "unit/sanitizer.h"
#include "virtual_lights/tiles/tiled_lighting.h"

#include <lightcull/error.h>
#include <lightcull/virtual_lights/scene_virtual_lights.h>
#include <lightcull/virtual_lights/virtual_light_renderer.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

/// These tests show virtual lights among the lights that the path tracer's samplers choose from.

using namespace render_support;
using statistics::Accumulator;
using statistics::Estimate;

namespace {

/// A floor and a wall, a ball of some material, and a lamp over it.
std::shared_ptr<Scene> corner(const Material& of_ball) {
    Shape room;
    room.add_level_square({0, 0, 0}, 2.0f, true);
    room.add_quad({-2, 0, -2}, {2, 0, -2}, {2, 3, -2}, {-2, 3, -2});
    return ball_under_lamp(room, of_ball);
}

std::shared_ptr<Scene> corner(float roughness) {
    return corner(gloss(roughness));
}

bool is_glossy(const Light& light) {
    return light.lobe_alpha > 0.0f;
}

constexpr std::uint32_t kEdge = 32, kBlock = 8;

std::vector<Estimate> blocks(const std::shared_ptr<const Scene>& scene, std::string_view sampler,
                             std::uint32_t passes) {
    RenderSettings settings = square_image(kEdge, 2);
    settings.seed = passes;  // no two renders share random numbers
    return render_blocks(scene, settings, make_scene_sampler(sampler, *scene, settings), passes,
                         kBlock);
}

}  // namespace

TEST_CASE("over virtual lights culled gives the mean of exhaustive, from sharp to rough") {
    for (const float roughness : {0.05f, 0.15f, 0.3f, 0.5f}) {
        CAPTURE(roughness);
        const auto scene = corner(roughness);
        add_virtual_lights(*scene, 600, 1);
        scene->commit();
        const Span<const Light> lights = scene->lights();
        CHECK(std::count_if(lights.begin(), lights.end(), is_glossy) > 20);
        CHECK(lights.size() > 300);

        constexpr std::uint32_t kPasses = lightcull::testing::repetitions(300, 75);
        const std::vector<Estimate> exact = blocks(scene, "exhaustive", kPasses);
        for (const char* sampler : {"culled:accepted=8", "culled:accepted=40:sets=4"}) {
            CAPTURE(sampler);
            CHECK(statistics::worst_p(blocks(scene, sampler, kPasses + 1), exact) >
                  statistics::least_p());
        }
        // The test sees an image that is too dark.
        CHECK(statistics::worst_p(blocks(scene, "clamped:accepted=8", kPasses + 2), exact) <
              statistics::least_p());
    }
}

TEST_CASE("over diffuse virtual lights alone culled, in groups, gives the mean of exhaustive") {
    const auto scene = corner(diffuse(0.7f));
    add_virtual_lights(*scene, 600, 2);
    scene->commit();
    CHECK(std::none_of(scene->lights().begin(), scene->lights().end(), is_glossy));
    const std::vector<Estimate> exact = blocks(scene, "exhaustive", 300);
    for (const char* sampler : {"culled:accepted=4:group=20", "culled:accepted=8:group=1"}) {
        CAPTURE(sampler);
        CHECK(statistics::worst_p(blocks(scene, sampler, 301), exact) > statistics::least_p());
    }
}

TEST_CASE("with virtual lights direct light is what paths find that bounce") {
    const auto plain = corner(1.0f);
    plain->commit();
    const Estimate traced = render_mean(plain, square_image(kEdge, 4), "power", 500);
    Accumulator by_seed;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const auto scene = corner(1.0f);
        add_virtual_lights(*scene, 3000, 2, seed);
        scene->commit();
        by_seed.add(render_mean(scene, square_image(kEdge, 2), "culled", 10).mean);
    }
    const double direct = render_mean(plain, square_image(kEdge, 2), "power", 100).mean;
    CHECK(traced.mean > 1.1 * direct);
    CHECK(std::sqrt(by_seed.estimate().variance) < 0.005 * traced.mean);
    // Light within the least distance of a virtual light is missing: a per cent or two.
    CHECK(by_seed.estimate().mean == doctest::Approx(traced.mean).epsilon(0.025).scale(0.0));
}

TEST_CASE("virtual lights of a scene depend on the seed alone, and add to what there is") {
    const auto lights_of = [](std::uint64_t seed) {
        const auto scene = corner(0.3f);
        add_virtual_lights(*scene, 100, 1, seed);
        return std::vector<Light>(scene->lights().begin(), scene->lights().end());
    };
    const std::vector<Light> first = lights_of(1), again = lights_of(1), other = lights_of(2);
    REQUIRE(first.size() == again.size());
    bool differs = other.size() != first.size();
    for (std::size_t i = 0; i < first.size(); ++i) {
        CHECK(first[i].center.x == again[i].center.x);
        differs = differs || first[i].center.x != other[i].center.x;
    }
    CHECK(differs);
    CHECK(first[0].cos_theta_o == 1.0f);  // the lamp
    CHECK(first[0].radius > 0.0f);

    const auto scene = corner(0.3f);
    add_virtual_lights(*scene, 100, 1);
    const std::size_t before = scene->lights().size();
    scene->add_point_light({0, 2, 0}, {1, 1, 1});  // it is still open
    scene->commit();
    CHECK(scene->lights().size() == before + 1);
}

TEST_CASE("virtual lights of a scene: samplers know where they shine, and all the least distance") {
    const auto scene = corner(0.3f);
    const std::size_t first = scene->lights().size();
    add_virtual_lights(*scene, 200, 2);
    const std::vector<VirtualLight>& lights = data_of(*scene).virtual_lights;
    REQUIRE(scene->lights().size() == first + lights.size());
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const VirtualLight& light = lights[i];
        const Light& known = scene->lights()[first + i];
        const V3f mirrored =
            light.normal * (2.0f * light.normal.dot(light.incoming)) - light.incoming;
        const V3f peak = light.lobe == Lobe::kGlossy ? mirrored : light.normal;
        CHECK(peak.dot(lightcull::to_v3f(known.axis)) == doctest::Approx(1.0));
    }
    CHECK(data_of(*scene).virtual_nearest2 > 0.0f);
    CHECK(data_of(*scene).virtual_nearest2 == nearest_distance2(lights));
}

TEST_CASE("virtual lights of a scene: what makes no sense is refused, darkness gives none") {
    const auto message = [](const auto& action) {
        try {
            action();
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const auto scene = corner(0.3f);
    CHECK(message([&] { add_virtual_lights(*scene, 0, 1); }) ==
          "virtual lights: light_paths is 0, wanted 1 to 16777216");
    CHECK(message([&] { add_virtual_lights(*scene, 9, 4); }) ==
          "virtual lights: bounces is 4, wanted 1 to 3");
    add_virtual_lights(*scene, 100, 1);
    CHECK(message([&] { add_virtual_lights(*scene, 100, 1); }) ==
          "virtual lights: the scene has some among its lights already");
    scene->commit();
    CHECK(message([&] { render_mean(scene, square_image(8, 3)); }) ==
          "renderer: max_depth is 3, and the scene has virtual lights, which are all that "
          "bounces: wanted 1 or 2");
    const RenderSettings settings = square_image(8, 3);
    CHECK(message([&] {
              const VirtualLightRenderer renderer(scene, settings, {},
                                                  make_scene_sampler("power", *scene, settings));
          }) == "virtual lights: the scene has some among its lights already");

    const auto committed_before = corner(0.3f);
    committed_before->commit();
    CHECK(message([&] { add_virtual_lights(*committed_before, 9, 1); }) ==
          "scene: nothing can be changed after commit()");
    CHECK(message([&] { render_mean(committed_before, square_image(8, 2), "power", 1); }).empty());

    CHECK(message([&] { add_virtual_lights(*corner(0.0f), 9, 1); }).find("roughness 0") !=
          std::string::npos);
    const auto dark = std::make_shared<Scene>();
    add_virtual_lights(*dark, 9, 1);
    CHECK(dark->lights().empty());
}
