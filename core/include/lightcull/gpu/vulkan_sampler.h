#pragma once

#include <lightcull/export.h>
#include <lightcull/light_sampler.h>

#include <memory>
#include <string>
#include <vector>

namespace lightcull {

/// A device that Vulkan knows of.
struct VulkanDevice {
    std::string name;
    std::string problem;  ///< why the device cannot be used; empty if it can
};

/// The devices of this machine, best first: GPUs of their own, integrated ones, others, processors.
/// Throws Error where there is no Vulkan.
LIGHTCULL_EXPORT std::vector<VulkanDevice> vulkan_devices();

struct VulkanOptions {
    std::string device;  ///< part of the device's name; empty: the first that can be used
    double timeout_seconds = 60.0;  ///< seconds allowed for what the device is given at a time,
                                    ///< > 0: some hundred thousand points, or a pass's ranges
};

/// Takes a sampler, `culled` or `paper` with a list, as make_sampler() gives it, to a device, which
/// from then on chooses for batches as that sampler would: by the same records, the same random
/// ranges and the same arithmetic, so that all but ties to the last bit fall alike. The other calls
/// are answered by the sampler itself: select() of one point is not for GPUs, and a device holds
/// the ranges of one pass, so that a pass() is one of the processor's. Batches from several
/// threads are done one after the other.
///
/// Throws Error that names what is at fault: another sampler, no Vulkan, no device of
/// that name, one that cannot be used, or one without enough memory.
///
/// If the device fails later (lost, out of memory, no answer in time), it is let go of, and
/// select(), which cannot throw, goes on with the sampler it was made from, whose selections are as
/// good; the next begin_pass() begins its pass there and then throws Error, once. A host may then
/// go on or stop. One that does not answer is waited for once more when it is let go of.
LIGHTCULL_EXPORT std::unique_ptr<LightSampler> make_vulkan_sampler(
    std::unique_ptr<LightSampler> sampler, const VulkanOptions& options = {});

}  // namespace lightcull
