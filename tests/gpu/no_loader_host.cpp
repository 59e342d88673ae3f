// A host on a machine without a loader for Vulkan, which the test plays by hiding it: it is told
// so, and goes on with the processor.

#include <lightcull/error.h>
#include <lightcull/gpu/vulkan_sampler.h>
#include <lightcull/samplers.h>

#include <cstdio>
#include <string>
#include <vector>

using namespace lightcull;

namespace {

template <typename Action>
bool is_told(const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        std::puts(error.what());
        return error.what() ==
               std::string("Vulkan: this machine has no loader for it (libvulkan.so.1)");
    }
    std::puts("no error");
    return false;
}

}  // namespace

int main() {
    const std::vector<Light> lights(1'000, point_light({0, 2, 0}, 1.0f));
    const bool told = is_told([] { vulkan_devices(); }) &&
                      is_told([&] { make_vulkan_sampler(make_sampler(CulledOptions{}, lights)); });
    const auto cpu = make_sampler(CulledOptions{}, lights);
    cpu->begin_pass(0);
    return told && cpu->select({{0, 0, 0}, {0, 1, 0}}, 0.5f).prob > 0.0f ? 0 : 1;
}
