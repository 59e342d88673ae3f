#include "gpu/device.h"

#include <lightcull/error.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

namespace lightcull {
namespace {

constexpr std::uint32_t kApiVersion = VK_API_VERSION_1_1;

vk::raii::Context load_vulkan() {
    try {
        return vk::raii::Context();
    } catch (const std::exception&) {
        throw Error("Vulkan: this machine has no loader for it (libvulkan.so.1)");
    }
}

vk::raii::Instance make_instance(const vk::raii::Context& context) {
    try {
        const vk::ApplicationInfo application("lightcull", 1, nullptr, 0, kApiVersion);
        return vk::raii::Instance(context, vk::InstanceCreateInfo({}, &application));
    } catch (const vk::IncompatibleDriverError&) {
        throw Error("Vulkan: this machine has no driver for it");
    } catch (const vk::Error&) {
        rethrow_as_error("Vulkan: no instance of it");
    }
}

std::optional<std::uint32_t> compute_queue_family(const vk::raii::PhysicalDevice& device) {
    const auto families = device.getQueueFamilyProperties();
    for (std::uint32_t i = 0; i < families.size(); ++i) {
        if (families[i].queueFlags & vk::QueueFlagBits::eCompute) return i;
    }
    return std::nullopt;
}

/// The reason why a device cannot be used; empty if it can.
std::string problem_of(const vk::raii::PhysicalDevice& device) {
    constexpr std::uint32_t kBuffers = 8;  // storage buffers of a shader
    const vk::PhysicalDeviceFeatures features = device.getFeatures();
    const vk::PhysicalDeviceProperties properties = device.getProperties();
    if (properties.apiVersion < kApiVersion) return "older than Vulkan 1.1";
    if (!compute_queue_family(device)) return "no queue for compute";
    if (properties.limits.maxPerStageDescriptorStorageBuffers < kBuffers) {
        return "too few storage buffers for a shader";
    }
    if (features.shaderFloat64 == VK_FALSE) return "no 64-bit floats";
    if (features.shaderInt64 == VK_FALSE) return "no 64-bit integers";
    return {};
}

int rank_of(const vk::raii::PhysicalDevice& device) {
    switch (device.getProperties().deviceType) {
        case vk::PhysicalDeviceType::eDiscreteGpu:
            return 0;
        case vk::PhysicalDeviceType::eIntegratedGpu:
            return 1;
        case vk::PhysicalDeviceType::eCpu:
            return 3;
        default:
            return 2;
    }
}

/// The devices, best first; at least one.
std::vector<vk::raii::PhysicalDevice> devices_of(const vk::raii::Instance& instance) try {
    std::vector<vk::raii::PhysicalDevice> devices;
    for (vk::raii::PhysicalDevice& device : vk::raii::PhysicalDevices(instance)) {
        devices.push_back(std::move(device));
    }
    if (devices.empty()) throw Error("Vulkan: this machine has a driver for it, but no device");
    std::stable_sort(devices.begin(), devices.end(),
                     [](const auto& a, const auto& b) { return rank_of(a) < rank_of(b); });
    return devices;
} catch (const vk::Error&) {
    rethrow_as_error("Vulkan: the list of devices");
}

std::string name_of(const vk::raii::PhysicalDevice& device) {
    return std::string(std::string_view(device.getProperties().deviceName));
}

/// The first device whose name holds `part`, and which can be used if any of them can.
vk::raii::PhysicalDevice choose(const vk::raii::Instance& instance, const std::string& part) {
    std::string known, problems;
    for (vk::raii::PhysicalDevice& device : devices_of(instance)) {
        const std::string name = name_of(device);
        known += known.empty() ? "" : ", ";
        known += name;
        if (name.find(part) == std::string::npos) continue;
        const std::string problem = problem_of(device);
        if (problem.empty()) return std::move(device);
        problems += problems.empty() ? "" : "; ";
        problems.append(name).append(": ").append(problem);
    }
    if (!problems.empty()) throw Error("Vulkan: no device that can be used (" + problems + ")");
    throw Error("Vulkan: no device '" + part + "'; there are: " + known);
}

vk::raii::Device make_device(const vk::raii::PhysicalDevice& physical, std::uint32_t family) {
    constexpr float kPriority = 1.0f;
    const vk::DeviceQueueCreateInfo queue({}, family, 1, &kPriority);
    vk::PhysicalDeviceFeatures features;
    features.shaderFloat64 = VK_TRUE;
    features.shaderInt64 = VK_TRUE;
    vk::DeviceCreateInfo info({}, queue);
    info.pEnabledFeatures = &features;
    return vk::raii::Device(physical, info);
}

}  // namespace

void rethrow_as_error(const std::string& where) {
    try {
        throw;
    } catch (const vk::DeviceLostError&) {
        throw Error(where + ": the device was lost");
    } catch (const vk::OutOfDeviceMemoryError&) {
        throw Error(where + ": out of device memory");
    } catch (const vk::OutOfHostMemoryError&) {
        throw Error(where + ": out of memory");
    } catch (const std::exception& error) {
        throw Error(where + ": " + error.what());
    }
}

std::vector<VulkanDevice> vulkan_devices() {
    const vk::raii::Context context = load_vulkan();
    const vk::raii::Instance instance = make_instance(context);
    std::vector<VulkanDevice> result;
    for (const vk::raii::PhysicalDevice& device : devices_of(instance)) {
        result.push_back({name_of(device), problem_of(device)});
    }
    return result;
}

Device::Device(const std::string& name_part)
    : context_(load_vulkan()),
      instance_(make_instance(context_)),
      physical_(choose(instance_, name_part)),
      name_("Vulkan device '" + name_of(physical_) + "'"),
      queue_family_(*compute_queue_family(physical_)),
      device_(make_device(physical_, queue_family_)),
      queue_(device_, queue_family_, 0),
      pool_(device_, vk::CommandPoolCreateInfo(vk::CommandPoolCreateFlagBits::eResetCommandBuffer,
                                               queue_family_)),
      commands_(std::move(vk::raii::CommandBuffers(
          device_, vk::CommandBufferAllocateInfo(*pool_, vk::CommandBufferLevel::ePrimary, 1))[0])),
      done_(device_, vk::FenceCreateInfo()) {
}

vk::raii::DeviceMemory Device::allocate(const vk::MemoryRequirements& needs,
                                        vk::MemoryPropertyFlags wanted,
                                        vk::MemoryPropertyFlags others) const {
    const vk::PhysicalDeviceMemoryProperties memory = physical_.getMemoryProperties();
    for (const vk::MemoryPropertyFlags flags : {wanted | others, wanted}) {
        for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
            const vk::MemoryType& type = memory.memoryTypes[i];
            const bool fits = (needs.memoryTypeBits & (1u << i)) != 0 &&
                              (type.propertyFlags & flags) == flags &&
                              memory.memoryHeaps[type.heapIndex].size >= needs.size;
            if (fits) return {device_, vk::MemoryAllocateInfo(needs.size, i)};
        }
    }
    throw vk::OutOfDeviceMemoryError("no heap is as large");
}

std::size_t Device::checked_size(const std::string& what, std::size_t bytes) const {
    const std::size_t most = physical_.getProperties().limits.maxStorageBufferRange;
    if (bytes <= most) return bytes;
    throw Error(name_ + ": " + what + " take " + std::to_string(bytes) + " bytes, more than the " +
                std::to_string(most) + " of a buffer");
}

void Device::check_shared_memory(std::size_t bytes) const {
    const std::size_t most = physical_.getProperties().limits.maxComputeSharedMemorySize;
    if (bytes <= most) return;
    throw Error(name_ + ": the lists of a workgroup take " + std::to_string(bytes) +
                " bytes, more than the " + std::to_string(most) + " that it shares");
}

void Device::run(double timeout_seconds,
                 const std::function<void(const vk::raii::CommandBuffer&)>& record) {
    try {
        commands_.begin(vk::CommandBufferBeginInfo(vk::CommandBufferUsageFlagBits::eOneTimeSubmit));
        record(commands_);
        commands_.end();
        queue_.submit(vk::SubmitInfo({}, {}, *commands_), *done_);
        at_work_ = true;
        if (finishes_within(timeout_seconds)) return;
    } catch (const vk::Error&) {
        rethrow_as_error(name_);
    }
    std::ostringstream message;
    message << name_ << ": no answer within " << timeout_seconds << " s";
    throw Error(message.str());
}

bool Device::finishes_within(double seconds) {
    if (!at_work_) return true;
    const auto timeout_ns = static_cast<std::uint64_t>(seconds * 1e9);
    if (device_.waitForFences(*done_, VK_TRUE, timeout_ns) == vk::Result::eTimeout) return false;
    device_.resetFences(*done_);
    at_work_ = false;
    return true;
}

bool Device::is_idle_within(double seconds) noexcept {
    try {
        return finishes_within(seconds);
    } catch (const vk::Error&) {
        return true;  // it is lost: nothing is at work any more
    }
}

void barrier(const vk::raii::CommandBuffer& commands) {
    using Stage = vk::PipelineStageFlagBits;
    using Access = vk::AccessFlagBits;
    const vk::MemoryBarrier memory(Access::eShaderWrite | Access::eTransferWrite,
                                   Access::eShaderRead | Access::eShaderWrite |
                                       Access::eTransferRead | Access::eTransferWrite |
                                       Access::eHostRead);
    commands.pipelineBarrier(Stage::eComputeShader | Stage::eTransfer,
                             Stage::eComputeShader | Stage::eTransfer | Stage::eHost, {}, memory,
                             {}, {});
}

}  // namespace lightcull
