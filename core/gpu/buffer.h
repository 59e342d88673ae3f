#pragma once

#include <lightcull/span.h>

#include <cstddef>
#include <string>

#include "gpu/device.h"

namespace lightcull {

/// Memory of a device, for storage buffers of shaders.
class Buffer {
  public:
    /// Throws Error that names `what` if there is not so much memory. bytes > 0.
    Buffer(const Device& device, const std::string& what, std::size_t bytes);

    vk::Buffer get() const noexcept { return *buffer_; }
    std::size_t size() const noexcept { return size_; }

  private:
    std::size_t size_;
    vk::raii::Buffer buffer_;
    vk::raii::DeviceMemory memory_;
};

/// Memory that the device and the host both see, through which everything goes.
class StagingBuffer {
  public:
    /// bytes > 0. Throws Error.
    StagingBuffer(const Device& device, std::size_t bytes);

    vk::Buffer get() const noexcept { return *buffer_; }
    std::byte* data() const noexcept { return data_; }
    std::size_t size() const noexcept { return size_; }

  private:
    std::size_t size_;
    vk::raii::Buffer buffer_;
    vk::raii::DeviceMemory memory_;
    std::byte* data_;
};

}  // namespace lightcull
