#include "gpu/buffer.h"

#include <algorithm>

namespace lightcull {
namespace {

vk::raii::Buffer make_buffer(const Device& device, std::size_t bytes) {
    using Usage = vk::BufferUsageFlagBits;
    return {device.get(),
            vk::BufferCreateInfo(
                {}, bytes, Usage::eStorageBuffer | Usage::eTransferSrc | Usage::eTransferDst)};
}

vk::raii::DeviceMemory allocate(const Device& device, const vk::raii::Buffer& buffer,
                                const std::string& what, vk::MemoryPropertyFlags properties) {
    const vk::MemoryRequirements needs = buffer.getMemoryRequirements();
    try {
        vk::raii::DeviceMemory memory(
            device.get(), vk::MemoryAllocateInfo(
                              needs.size, device.memory_type(needs.memoryTypeBits, properties)));
        buffer.bindMemory(*memory, 0);
        return memory;
    } catch (const vk::Error&) {
        rethrow_as_error(device.name() + ": " + std::to_string(needs.size) + " bytes for " + what);
    }
}

}  // namespace

Buffer::Buffer(const Device& device, const std::string& what, std::size_t bytes)
    : size_(device.checked_size(what, bytes)),
      buffer_(make_buffer(device, bytes)),
      memory_(allocate(device, buffer_, what, vk::MemoryPropertyFlagBits::eDeviceLocal)) {
}

StagingBuffer::StagingBuffer(const Device& device, std::size_t bytes)
    : device_(device),
      buffer_(make_buffer(device, bytes)),
      memory_(allocate(
          device, buffer_, "transfers",
          vk::MemoryPropertyFlagBits::eHostVisible | vk::MemoryPropertyFlagBits::eHostCoherent)),
      data_(static_cast<std::byte*>(memory_.mapMemory(0, VK_WHOLE_SIZE))) {
}

Buffer upload_bytes(Device& device, const std::string& what, Span<const std::byte> bytes) {
    Buffer buffer(device, what, bytes.size());
    const StagingBuffer staging(device, bytes.size());
    constexpr double kSeconds = 60.0;  // for all that fits into memory
    std::copy(bytes.begin(), bytes.end(), staging.data());
    device.run(kSeconds, [&](const vk::raii::CommandBuffer& commands) {
        commands.copyBuffer(staging.get(), buffer.get(), vk::BufferCopy(0, 0, bytes.size()));
        barrier(commands);
    });
    return buffer;
}

}  // namespace lightcull
