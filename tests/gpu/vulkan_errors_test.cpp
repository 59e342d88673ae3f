#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <vector>

#include "device_support.h"

using namespace lightcull;
using namespace lightcull::testing;

TEST_CASE("the devices of this machine are listed, and one of them can be used") {
    const std::vector<VulkanDevice> devices = vulkan_devices();
    REQUIRE(!devices.empty());
    CHECK(!devices.front().name.empty());
    CHECK(devices.front().problem.empty());
    VulkanOptions options;
    options.device = devices.front().name;
    CHECK(make_vulkan_sampler(culled(), options) != nullptr);
}

TEST_CASE("set-up says in one line what is at fault") {
    CHECK(error_of([] {
              make_vulkan_sampler(make_sampler("paper:list=0", mixed_lights(9, 75)));
          }) == "Vulkan: of the samplers, only culled and paper (with a list) run on a device");
    CHECK(error_of([] { make_vulkan_sampler(make_sampler("power", mixed_lights(9, 75))); }) ==
          "Vulkan: of the samplers, only culled and paper (with a list) run on a device");
    std::vector<Light> lights = mixed_lights(9, 75);
    lights.push_back(glossy_point_light({0, 0, 0}, {0, 1, 0}, 1.0f, 0.1f));
    for (const char* glossy : {"culled", "paper"}) {
        CHECK(error_of([&] { make_vulkan_sampler(make_sampler(glossy, lights)); }) ==
              "Vulkan: there are glossy points among the lights, which no device chooses");
    }
    VulkanOptions options;
    options.device = "no such";
    CHECK(error_of([&] {
              make_vulkan_sampler(culled(), options);
          }).find("Vulkan: no device 'no such'; there are: " + vulkan_devices().front().name) == 0);
    for (const double seconds : {0.0, -1.0, 1e7, std::numeric_limits<double>::quiet_NaN()}) {
        options = {};
        options.timeout_seconds = seconds;
        CHECK(error_of([&] {
                  make_vulkan_sampler(culled(), options);
              }).find("timeout_seconds is ") == 0);
    }
}

TEST_CASE("a machine without a driver for Vulkan is an error, and nothing else stops") {
    const Environment none("VK_DRIVER_FILES", "/nonexistent.json");
    CHECK(error_of([] { vulkan_devices(); }) == "Vulkan: this machine has no driver for it");
    CHECK(error_of([] { make_vulkan_sampler(culled()); }) ==
          "Vulkan: this machine has no driver for it");
    const auto cpu = culled();
    cpu->begin_pass(0);
    CHECK(cpu->select({}, 0.5f).prob > 0.0f);
}

TEST_CASE("without lights nothing is chosen, and no error") {
    const auto sampler = make_vulkan_sampler(make_sampler("culled:sets=4", {}));
    sampler->begin_pass(0);
    CHECK(sampler->select({}, 0.5f).prob == 0.0f);
    const std::vector<ShadingPoint> points(100);
    const std::vector<float> u(points.size(), 0.3f);
    std::vector<Selection> selections(points.size());
    sampler->select(points, u, selections);
    for (const Selection& selection : selections) CHECK(selection.prob == 0.0f);
}
