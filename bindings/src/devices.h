#pragma once

#include <lightcull/light_sampler.h>

#include <memory>
#include <string>

namespace lightcull::python {

/// The sampler, taken to a device: "cpu", which leaves it as it is; "vulkan", the best that Vulkan
/// knows of; "vulkan:NAME", a device whose name holds NAME. Throws Error.
std::unique_ptr<LightSampler> on_device(std::unique_ptr<LightSampler> sampler,
                                        const std::string& device);

}  // namespace lightcull::python
