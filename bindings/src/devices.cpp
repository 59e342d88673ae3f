#include "devices.h"
#include "module.h"

#include <lightcull/error.h>

#ifdef LIGHTCULL_VULKAN
#include <lightcull/gpu/vulkan_sampler.h>
#endif

#include <pybind11/stl.h>

#include <string_view>
#include <utility>
#include <vector>

namespace lightcull::python {
namespace {

constexpr std::string_view kVulkan = "vulkan";

#ifdef LIGHTCULL_VULKAN
std::vector<std::pair<std::string, std::string>> vulkan_devices() {
    std::vector<std::pair<std::string, std::string>> devices;
    for (const VulkanDevice& device : lightcull::vulkan_devices()) {
        devices.emplace_back(device.name, device.problem);
    }
    return devices;
}

std::unique_ptr<LightSampler> on_vulkan(std::unique_ptr<LightSampler> sampler,
                                        const std::string& name) {
    VulkanOptions options;
    options.device = name;
    return make_vulkan_sampler(std::move(sampler), options);
}
#else
std::vector<std::pair<std::string, std::string>> vulkan_devices() {
    throw Error("Vulkan: this lightcull was built without it");
}

std::unique_ptr<LightSampler> on_vulkan(std::unique_ptr<LightSampler>, const std::string&) {
    throw Error("Vulkan: this lightcull was built without it");
}
#endif

}  // namespace

std::unique_ptr<LightSampler> on_device(std::unique_ptr<LightSampler> sampler,
                                        const std::string& device) {
    if (device == "cpu") return sampler;
    const std::size_t colon = device.find(':');
    if (device.substr(0, colon) == kVulkan) {
        const std::string name = colon == std::string::npos ? "" : device.substr(colon + 1);
        return on_vulkan(std::move(sampler), name);
    }
    throw Error("device '" + device + "': unknown; there are cpu, vulkan and vulkan:NAME");
}

void bind_devices(pybind11::module_& module) {
    module.def("vulkan_devices", &vulkan_devices,
               pybind11::call_guard<pybind11::gil_scoped_release>());
}

}  // namespace lightcull::python
