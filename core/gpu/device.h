#pragma once

#include <lightcull/gpu/vulkan_sampler.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "gpu/vulkan.h"

namespace lightcull {

/// Throws, for an exception of Vulkan that is being handled, an Error that says where and what.
[[noreturn]] void rethrow_as_error(const std::string& where);

/// A device that can do what the shaders need, with one queue. For one thread at a time.
class Device {
  public:
    /// name_part: part of the device's name, or empty (VulkanOptions::device).
    explicit Device(const std::string& name_part);

    const vk::raii::Device& get() const noexcept { return device_; }
    const std::string& name() const noexcept { return name_; }

    /// Allocates memory with all of the wanted properties, and the others if there is such. Throws
    /// vk::Error.
    vk::raii::DeviceMemory allocate(const vk::MemoryRequirements& needs,
                                    vk::MemoryPropertyFlags wanted,
                                    vk::MemoryPropertyFlags others = {}) const;
    /// Returns `bytes`, or throws Error if a buffer of so many is more than a shader can see.
    std::size_t checked_size(const std::string& what, std::size_t bytes) const;

    /// Throws Error if a workgroup has not as many bytes to share.
    void check_shared_memory(std::size_t bytes) const;

    /// Lets the device do what record() puts down, and waits for it. After an Error the device may
    /// still be at work, and is not to be used again.
    void run(double timeout_seconds,
             const std::function<void(const vk::raii::CommandBuffer&)>& record);
    /// True if the device has done all that it was given, or is lost: waits for that, but not for
    /// longer.
    bool is_idle_within(double seconds) noexcept;

  private:
    /// True if the work ends in time. Throws vk::Error.
    bool finishes_within(double seconds);

    vk::raii::Context context_;
    vk::raii::Instance instance_;
    vk::raii::PhysicalDevice physical_;
    std::string name_;
    std::uint32_t queue_family_;
    vk::raii::Device device_;
    vk::raii::Queue queue_;
    vk::raii::CommandPool pool_;
    vk::raii::CommandBuffer commands_;
    vk::raii::Fence done_;
    bool at_work_ = false;
};

/// Makes everything that was written before, by copies or shaders, seen by what comes after.
void barrier(const vk::raii::CommandBuffer& commands);

}  // namespace lightcull
