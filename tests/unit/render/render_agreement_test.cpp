#include "base/random.h"
#include "unit/render/render_support.h"
#include "unit/sanitizer.h"

#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

/// These tests show that every way to render a scene gives the same image in the mean, block by
/// block, and that they see it when a way is wrong.

using namespace render_support;
using statistics::Estimate;

namespace {

constexpr std::uint32_t kEdge = 32, kBlock = 8;

/// The share of all passes that is made.
constexpr double kShare = lightcull::testing::repetitions(1.0, 0.25);

/// Lamps of many powers over a floor, boxes of wall around it.
std::shared_ptr<const Scene> hall(const Material& floor_material, bool only_areas, bool sky) {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.6f));
    scene->add_material(floor_material);
    Shape floor, walls, lamps;
    floor.add_level_square({0, 0, 0}, 4.0f, true);
    walls.add_quad({-4, 0, -4}, {4, 0, -4}, {4, 3, -4}, {-4, 3, -4});
    walls.add_quad({-4, 0, 4}, {-4, 0, -4}, {-4, 3, -4}, {-4, 3, 4});
    walls.add_sphere({1.2f, 0.7f, -0.5f}, 0.7f, 10);
    std::vector<float3> powers;
    lightcull::RandomStream random(5);
    for (int i = 0; i < 49; ++i) {
        const int row = i / 7 - 3;
        const auto x = static_cast<float>(i % 7 - 3), z = static_cast<float>(row);
        lamps.add_level_square({1.1f * x, 1.2f + random.next(), 1.1f * z},
                               0.1f + 0.25f * random.next(), false);
        const float power = std::exp(3.0f * random.next());
        powers.insert(powers.end(), 2, {power, power, power});
    }
    Emission e = emission(1.0f);
    e.face_radiance = powers;
    scene->add_mesh(floor.mesh("floor", 1));
    scene->add_mesh(walls.mesh("walls", 0));
    scene->add_mesh(lamps.mesh("lamps", 0, e));
    if (!only_areas) {
        scene->add_point_light({-2, 2, 1}, {3, 3, 3});
        scene->add_spot_light({3, 2.5f, 3}, {-1, -1, -1}, {20, 20, 20}, 0.2f, 0.5f);
    }
    if (sky) scene->set_environment(constant_environment(0.5f));
    // The camera looks so low that no lamp is in sight: their edges would be most of the noise.
    scene->set_camera(look({0.5f, 1.0f, 5.5f}, {0.3f, -1.4f, 0}, 0.7f));
    return committed(scene);
}

Material glossy() {
    Material m = metal(0.45f, 0.8f);
    m.metallic = 0.7f;
    return m;
}

RenderSettings settings_of(DirectLight technique, std::uint32_t max_depth, std::uint64_t seed) {
    RenderSettings settings = square_image(kEdge, max_depth);
    settings.direct_light = technique;
    settings.seed = seed;
    return settings;
}

std::vector<Estimate> blocks(const std::shared_ptr<const Scene>& scene,
                             const RenderSettings& settings, std::unique_ptr<LightSampler> sampler,
                             std::uint32_t passes) {
    const auto made = static_cast<std::uint32_t>(kShare * passes);
    return render_blocks(scene, settings, std::move(sampler), made, kBlock);
}

std::vector<Estimate> blocks(const std::shared_ptr<const Scene>& scene,
                             const RenderSettings& settings, std::string_view sampler,
                             std::uint32_t passes) {
    return blocks(scene, settings, make_scene_sampler(sampler, *scene, settings), passes);
}

bool agree(const std::vector<Estimate>& a, const std::vector<Estimate>& b) {
    return statistics::worst_p(a, b) > statistics::least_p();
}

/// The error of the image's mean, relative to it, were all passes made.
double relative_error(const std::vector<Estimate>& blocks) {
    return std::sqrt(kShare * blocks.back().variance) / blocks.back().mean;
}

enum class NaiveRule { kZero, kAcceptedOnly };

/// Another sampler, whose prob() is wrong for lights that were not accepted: 0 for all lights, or
/// g_i / W with W the sum over the accepted ones alone.
class NaiveSampler final : public ForwardingSampler {
  public:
    NaiveSampler(std::unique_ptr<LightSampler> inner, NaiveRule rule)
        : ForwardingSampler(std::move(inner)), rule_(rule) {}

    using ForwardingSampler::prob;
    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        if (rule_ == NaiveRule::kZero) return 0.0f;
        // The weight beside which the light's own is nothing, accepted or not.
        constexpr float kHuge = 1e20f;
        const float importance =
            kHuge * ForwardingSampler::prob(point, {kHuge, receipt.key}, light);
        return importance / receipt.weight_sum;
    }

  private:
    NaiveRule rule_;
};

}  // namespace

TEST_CASE("light sampling, BSDF sampling and both agree in the mean on a glossy floor") {
    for (const bool sky : {false, true}) {
        const auto scene = hall(glossy(), true, sky);
        const auto by_bsdf = blocks(scene, settings_of(DirectLight::kBsdf, 2, 1), "uniform", 3000);
        CHECK(relative_error(by_bsdf) < 0.004);
        for (const char* sampler : {"power", "culled:accepted=2:sets=16"}) {
            CAPTURE(sampler);
            CAPTURE(sky);
            const auto by_lights =
                blocks(scene, settings_of(DirectLight::kLights, 2, 2), sampler, 1000);
            const auto by_both = blocks(scene, settings_of(DirectLight::kMis, 2, 3), sampler, 1000);
            CHECK(agree(by_lights, by_bsdf));
            CHECK(agree(by_both, by_bsdf));
            CHECK(agree(by_both, by_lights));
            CHECK(relative_error(by_both) < 0.004);
        }
    }
}

TEST_CASE("the agreement of MIS fails with a naive rule for lights that were not accepted") {
    const auto scene = hall(glossy(), true, false);
    const auto reference = blocks(scene, settings_of(DirectLight::kMis, 2, 4), "power", 1000);
    for (const NaiveRule rule : {NaiveRule::kZero, NaiveRule::kAcceptedOnly}) {
        const RenderSettings settings = settings_of(DirectLight::kMis, 2, 5);
        auto culled = make_scene_sampler("culled:accepted=2:sets=16", *scene, settings);
        const auto naive =
            blocks(scene, settings, std::make_unique<NaiveSampler>(std::move(culled), rule), 1000);
        CHECK_FALSE(agree(naive, reference));
    }
}

TEST_CASE("every sampler's mean image is that of the exhaustive one") {
    Material floor = glossy();
    floor.roughness = 0.6f;
    const auto scene = hall(floor, false, true);
    for (const std::uint32_t max_depth : {2u, 3u}) {
        const RenderSettings settings = settings_of(DirectLight::kMis, max_depth, 6);
        const auto exhaustive = blocks(scene, settings, "exhaustive", 700);
        CHECK(relative_error(exhaustive) < 0.005);
        for (const char* sampler : {"uniform", "power", "light_bvh", "culled", "culled:accepted=3",
                                    "paper", "paper:test=light:weight=g_over_p:list=0:sets=4"}) {
            CAPTURE(sampler);
            CAPTURE(max_depth);
            const auto other =
                blocks(scene, settings_of(DirectLight::kMis, max_depth, 7), sampler, 700);
            CHECK(agree(other, exhaustive));
        }
        // The sampler `clamped`, biased as it is, must be caught.
        const auto clamped = blocks(scene, settings, "clamped:accepted=2", 700);
        CHECK_FALSE(agree(clamped, exhaustive));
    }
}
