#include "unit/render/render_support.h"

#include <doctest/doctest.h>

// Of paths whose last edge is there for MIS alone, a fourth may have to do.

namespace {
using namespace render_support;

constexpr std::uint32_t kEdge = 64;
constexpr int kPasses = 16;

/// A floor that the camera sees from above, and nothing else.
std::shared_ptr<Scene> floor_from_above() {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape floor;
    floor.add_level_square({0, 0, 0}, 4.0f, true);
    scene->add_mesh(floor.mesh("floor", 0));
    scene->set_camera(look({0, 5, 0}, {0, 0, 0}, 0.7f, {1, 0, 0}));
    return scene;
}

/// The same with a lamp over it.
std::shared_ptr<Scene> under_a_lamp(float half_edge, float height) {
    auto scene = floor_from_above();
    Shape lamp;
    lamp.add_level_square({0.5f, height, 0}, half_edge, false);
    scene->add_mesh(lamp.mesh("lamp", 0, emission(1.0f)));
    scene->commit();
    return scene;
}

std::unique_ptr<Renderer> rendered(const std::shared_ptr<const Scene>& scene,
                                   DirectLight direct_light, std::uint64_t seed = 0) {
    RenderSettings settings = square_image(kEdge, 2);
    settings.direct_light = direct_light;
    settings.seed = seed;
    auto renderer = std::make_unique<Renderer>(scene, settings,
                                               make_scene_sampler("learned", *scene, settings));
    for (int pass = 0; pass < kPasses; ++pass) renderer->render_pass();
    return renderer;
}

/// Rays of a sample after the first two: what is traced for MIS alone.
double last_rays(const std::shared_ptr<const Scene>& scene, DirectLight direct_light) {
    const auto rays = static_cast<double>(rendered(scene, direct_light)->stats().rays);
    return rays / (kPasses * kEdge * kEdge) - 2.0;
}

double mean(const std::shared_ptr<const Scene>& scene, DirectLight direct_light,
            std::uint64_t seed) {
    double sum = 0.0;
    for (const float3& pixel : rendered(scene, direct_light, seed)->image())
        sum += luminance(pixel);
    return sum / (kEdge * kEdge);
}

}  // namespace

TEST_CASE("last rays: a fourth of them is traced where they bring next to nothing") {
    const auto scene = under_a_lamp(0.05f, 3.0f);
    CHECK(last_rays(scene, DirectLight::kMis) == doctest::Approx(0.25).epsilon(0.05));
    CHECK(last_rays(scene, DirectLight::kLights) < 0.01);
}

TEST_CASE("last rays: all are traced where they find what light sampling does not") {
    auto scene = floor_from_above();
    scene->set_environment(constant_environment(1.0f));
    scene->commit();
    // Half of the sky's shadow rays would go below the floor, and are not traced.
    CHECK(last_rays(scene, DirectLight::kMis) == doctest::Approx(0.5).epsilon(0.05));
}

TEST_CASE("last rays: with a fourth of them the mean stays") {
    // Relative to the mean by light sampling alone; 4 sigma of 16 passes' means: a false alarm in
    // 16,000. A lamp so large and near that a fourth of the light is the last rays'.
    for (const float height : {3.0f, 0.6f}) {
        const auto scene = under_a_lamp(0.3f, height);
        statistics::Accumulator mis, lights;
        for (std::uint64_t seed = 0; seed < 16; ++seed) {
            mis.add(mean(scene, DirectLight::kMis, seed));
            lights.add(mean(scene, DirectLight::kLights, seed));
        }
        const auto a = mis.estimate(), b = lights.estimate();
        const double sigma = std::sqrt(a.variance + b.variance);
        CHECK(std::abs(a.mean - b.mean) < 4.0 * sigma);
        // The twin: weights that are off by as much as a fourth of what last rays bring are seen.
        CHECK_FALSE(std::abs(0.99 * a.mean - b.mean) < 4.0 * sigma);
    }
}
