#include <lightcull/gpu/vulkan_sampler.h>

#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <doctest/doctest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "../unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

std::unique_ptr<LightSampler> culled() {
    return make_sampler("culled:sets=4", mixed_lights(500, 75));
}

/// A variable of the environment for as long as this lives; it is not set otherwise.
struct Environment {
    const char* name;
    Environment(const char* variable, const char* value) : name(variable) {
        setenv(name, value, 1);
    }
    ~Environment() { unsetenv(name); }
};

/// What the action throws.
template <typename Action>
std::string error_of(const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

std::vector<Selection> select(const LightSampler& sampler) {
    const auto points = mixed_points(1'000, 76, sampler.set_count());
    const std::vector<float> u(points.size(), 0.3f);
    std::vector<Selection> selections(points.size());
    sampler.select(points, u, selections);
    return selections;
}

std::vector<std::uint32_t> lights_of(const std::vector<Selection>& selections) {
    std::vector<std::uint32_t> lights;
    for (const Selection& selection : selections) lights.push_back(selection.light);
    return lights;
}

}  // namespace

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
    VulkanOptions options;
    options.device = "no such";
    CHECK(error_of([&] {
              make_vulkan_sampler(culled(), options);
          }).find("Vulkan: no device 'no such'; there are: " + vulkan_devices().front().name) == 0);
    options = {};
    options.timeout_seconds = 0.0;
    CHECK(error_of([&] { make_vulkan_sampler(culled(), options); }).find("timeout_seconds is 0") ==
          0);
}

TEST_CASE("a machine without a driver for Vulkan is an error, and nothing else stops") {
    const Environment none("VK_ICD_FILENAMES", "/nonexistent.json");
    CHECK(error_of([] { vulkan_devices(); }) == "Vulkan: this machine has no driver for it");
    CHECK(error_of([] { make_vulkan_sampler(culled()); }) ==
          "Vulkan: this machine has no driver for it");
    CHECK(select(*culled()).front().prob > 0.0f);
}

TEST_CASE("a device that does not answer in time is told once, and the processor goes on") {
    const auto cpu = culled();
    VulkanOptions options;
    options.timeout_seconds = 1e-9;
    const auto gpu = make_vulkan_sampler(culled(), options);
    std::vector<std::string> errors;
    // Once in a while the work is done before it is waited for.
    for (std::uint64_t pass = 0; pass < 100; ++pass) {
        cpu->begin_pass(pass);
        const std::string error = error_of([&] { gpu->begin_pass(pass); });
        if (!error.empty()) errors.push_back(error);
        REQUIRE(lights_of(select(*gpu)) == lights_of(select(*cpu)));
    }
    REQUIRE(errors.size() == 1);
    CHECK(errors.front().find("no answer within") != std::string::npos);
}

TEST_CASE("without lights nothing is chosen, and no error") {
    const auto sampler = make_vulkan_sampler(make_sampler("culled:sets=4", {}));
    sampler->begin_pass(0);
    for (const Selection& selection : select(*sampler)) CHECK(selection.prob == 0.0f);
}
