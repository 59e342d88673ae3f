#include <lightcull/gpu/vulkan_sampler.h>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "unit/render/render_support.h"

using namespace render_support;
using statistics::Estimate;

namespace {

constexpr std::uint32_t kEdge = 32, kBlock = 8, kPasses = 200;

/// Lamps of many powers over a glossy floor, none of them in sight.
std::shared_ptr<const Scene> hall() {
    auto scene = std::make_shared<Scene>();
    scene->add_material(metal(0.5f, 0.8f));
    scene->add_material(diffuse(0.5f));
    Shape floor, lamps;
    floor.add_level_square({0, 0, 0}, 4.0f, true);
    std::vector<float3> powers;
    for (int i = 0; i < 64; ++i) {
        const int column = i % 8, row = i / 8;
        const auto x = static_cast<float>(column) - 3.5f, z = static_cast<float>(row) - 3.5f;
        lamps.add_level_square({x, 1.2f + 0.1f * static_cast<float>(i % 5), z}, 0.2f, false);
        const float power = std::exp(0.5f * static_cast<float>(i % 7));
        powers.insert(powers.end(), 2, {power, power, power});
    }
    Emission light = emission(1.0f);
    light.face_radiance = powers;
    scene->add_mesh(floor.mesh("floor", 0));
    scene->add_mesh(lamps.mesh("lamps", 1, light));
    scene->set_camera(look({0.5f, 1.0f, 5.5f}, {0.3f, -1.4f, 0}, 0.7f));
    return committed(scene);
}

RenderSettings settings_of(std::uint64_t seed) {
    RenderSettings settings = square_image(kEdge, 2);
    settings.seed = seed;
    return settings;
}

/// A device's selections, a little off.
class SkewedSampler final : public ForwardingSampler {
  public:
    using ForwardingSampler::ForwardingSampler;
    using ForwardingSampler::select;
    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const override {
        ForwardingSampler::select(points, u, selections);
        for (Selection& selection : selections) selection.prob *= 0.8f;
    }
};

std::unique_ptr<LightSampler> on_device(const Scene& scene, const RenderSettings& settings) {
    return make_vulkan_sampler(make_scene_sampler("culled:accepted=3:sets=4", scene, settings));
}

std::vector<Estimate> blocks(const std::shared_ptr<const Scene>& scene,
                             const RenderSettings& settings,
                             std::unique_ptr<LightSampler> sampler) {
    return render_blocks(scene, settings, std::move(sampler), kPasses, kBlock);
}

}  // namespace

TEST_CASE("the mean image by a device's selections is that of another sampler") {
    const auto scene = hall();
    const RenderSettings settings = settings_of(1), others = settings_of(2);
    const auto reference =
        blocks(scene, settings, make_scene_sampler("exhaustive", *scene, settings));
    const auto by_device = blocks(scene, others, on_device(*scene, others));
    CHECK(statistics::worst_p(by_device, reference) > statistics::least_p());
    // A sampler that is off by a fifth must be caught.
    const auto skewed =
        blocks(scene, others, std::make_unique<SkewedSampler>(on_device(*scene, others)));
    CHECK_FALSE(statistics::worst_p(skewed, reference) > statistics::least_p());
}
