#pragma once

#include <lightcull/span.h>

#include <cstddef>
#include <string>

#include "gpu/device.h"

namespace lightcull {

/// Memory of a device, for storage buffers of shaders.
class Buffer {
  public:
    /// Throws Error that names `what` if there is not so much. bytes > 0.
    Buffer(const Device& device, const std::string& what, std::size_t bytes);

    vk::Buffer get() const noexcept { return *buffer_; }
    std::size_t size() const noexcept { return size_; }

  private:
    std::size_t size_;
    vk::raii::Buffer buffer_;
    vk::raii::DeviceMemory memory_;
};

/// Memory that both sides see, through which everything goes. Its end waits for what the device is
/// at, as after a timeout it may still be at some.
class StagingBuffer {
  public:
    StagingBuffer(const Device& device, std::size_t bytes);
    StagingBuffer(StagingBuffer&&) = delete;
    ~StagingBuffer() { device_.wait_idle(); }

    vk::Buffer get() const noexcept { return *buffer_; }
    std::byte* data() const noexcept { return data_; }

  private:
    const Device& device_;
    vk::raii::Buffer buffer_;
    vk::raii::DeviceMemory memory_;
    std::byte* data_;
};

/// A buffer that holds these bytes from the start; not empty.
Buffer upload_bytes(Device& device, const std::string& what, Span<const std::byte> bytes);

/// The same of a container's elements.
template <typename Elements>
Buffer upload(Device& device, const std::string& what, const Elements& elements) {
    return upload_bytes(device, what,
                        {reinterpret_cast<const std::byte*>(elements.data()),
                         elements.size() * sizeof(*elements.data())});
}

}  // namespace lightcull
