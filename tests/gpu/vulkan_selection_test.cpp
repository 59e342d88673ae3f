#include <lightcull/gpu/vulkan_sampler.h>

#include <lightcull/samplers.h>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "base/random.h"
#include "close_call.h"
#include "lights/samplers/culled_scene.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

/// The number of points in each scene; LIGHTCULL_GPU_POINTS asks for another.
std::uint32_t point_count() {
    const char* wanted = std::getenv("LIGHTCULL_GPU_POINTS");
    return wanted == nullptr ? 20'000 : static_cast<std::uint32_t>(std::stoul(wanted));
}

std::vector<float> random_numbers(std::size_t count) {
    std::vector<float> u;
    for (std::size_t i = 0; i < count; ++i) u.push_back(uniform_float(hash(i, 71)));
    return u;
}

struct Case {
    std::uint32_t lights;
    const char* description;
};

/// The lights that the processor and a device choose at the same points.
struct BothWays {
    std::unique_ptr<LightSampler> cpu, gpu;
    std::vector<ShadingPoint> points;
    std::vector<float> u;
    std::vector<Selection> expected, selected;

    BothWays(const Case& scene, std::uint64_t seed) {
        const std::vector<Light> lights = with_suns(mixed_lights(scene.lights, seed, 6.0f), 100);
        cpu = make_sampler(scene.description, lights);
        gpu = make_vulkan_sampler(make_sampler(scene.description, lights));
        for (LightSampler* sampler : {cpu.get(), gpu.get()}) sampler->begin_pass(3);
        points = mixed_points(point_count(), 73, cpu->set_count());
        u = random_numbers(points.size());
        expected.resize(points.size());
        selected.resize(points.size());
        cpu->select(points, u, expected);
        gpu->select(points, u, selected);
    }
};

/// The cases. The last of them has more nodes than a walk reads first in, first out.
constexpr Case kCases[] = {{1, "culled"},
                           {30, "culled:sets=4"},
                           {1'000, "culled:sets=16"},
                           {250'000, "culled"},
                           {40'000, "culled:group=1:sets=4"}};

bool is_near(float a, float b) {
    return std::abs(a - b) <= 1e-5f * std::abs(b);
}

}  // namespace

TEST_CASE("a device chooses the light that the processor chooses, with its probability") {
    for (const Case& scene : kCases) {
        CAPTURE(scene.lights);
        const BothWays both(scene, 72);
        const auto& [cpu, gpu, points, u, expected, selected] = both;

        const CulledScene inside = dynamic_cast<const CulledSamplerBase&>(*cpu).scene();
        std::size_t different = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Selection &a = selected[i], &b = expected[i];
            REQUIRE(is_near(a.receipt.weight_sum, b.receipt.weight_sum));
            REQUIRE(a.receipt.key == points[i].set);
            if (a.light == b.light) {
                REQUIRE(is_near(a.prob, b.prob));
                continue;
            }
            ++different;
            REQUIRE(CloseCall(inside, points[i], u[i]).is_close());
            REQUIRE(is_near(a.prob, cpu->prob(points[i], a.receipt, a.light)));
        }
        MESSAGE(scene.lights << " lights: " << different << " of " << points.size()
                             << " selections differ, all of them ties");
        CHECK(static_cast<double>(different) <= 1e-4 * static_cast<double>(points.size()));
    }
}

TEST_CASE("a device keeps the paper's list as the processor does") {
    for (const Case& scene :
         {Case{20, "paper"}, Case{2'000, "paper:error_bound=auto:list=4:sets=4"},
          Case{2'000, "paper:list=64"},
          Case{2'000, "paper:error_bound=auto:test=light:weight=g_over_p"}}) {
        CAPTURE(scene.description);
        const BothWays both(scene, 79);
        const auto& [cpu, gpu, points, u, expected, selected] = both;
        std::size_t different = 0, found = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            found += expected[i].prob > 0.0f ? 1 : 0;
            const bool same =
                selected[i].light == expected[i].light &&
                is_near(selected[i].prob, expected[i].prob) &&
                is_near(selected[i].receipt.weight_sum, expected[i].receipt.weight_sum);
            different += same ? 0 : 1;
        }
        MESSAGE(std::string(scene.description)
                << ": " << different << " of " << points.size() << " selections differ");
        CHECK(static_cast<double>(different) <= 1e-4 * static_cast<double>(points.size()));
        CHECK(2 * found > points.size());
        CHECK(gpu->needs_receipt() == cpu->needs_receipt());
    }
}

TEST_CASE("few selections are so close that a device may decide them otherwise") {
    const auto sampler = make_sampler("culled:sets=16", mixed_lights(1'000, 72, 6.0f));
    sampler->begin_pass(3);
    const CulledScene inside = dynamic_cast<const CulledSamplerBase&>(*sampler).scene();
    const auto points = mixed_points(20'000, 73, sampler->set_count());
    const auto u = random_numbers(points.size());
    std::size_t close = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        close += CloseCall(inside, points[i], u[i]).is_close() ? 1 : 0;
    }
    CHECK(close < points.size() / 1000);
}

TEST_CASE("batches of any size, from a device's point of view") {
    const auto lights = mixed_lights(300, 77);
    const auto cpu = make_sampler("culled:sets=4", lights);
    const auto gpu = make_vulkan_sampler(make_sampler("culled:sets=4", lights));
    // The largest batch is handed over in two parts.
    for (const std::uint32_t count : {0u, 1u, 63u, 65u, (1u << 17) + 1u}) {
        CAPTURE(count);
        for (LightSampler* sampler : {cpu.get(), gpu.get()}) sampler->begin_pass(count);
        const auto points = mixed_points(count, 78, cpu->set_count());
        const auto u = random_numbers(count);
        std::vector<Selection> expected(count), selected(count);
        cpu->select(points, u, expected);
        gpu->select(points, u, selected);
        std::size_t different = 0;
        for (std::size_t i = 0; i < count; ++i) {
            different += selected[i].light == expected[i].light ? 0 : 1;
        }
        CHECK(static_cast<double>(different) <= 1e-4 * count);
    }
}
