#include "gpu/buffer.h"

namespace lightcull {
namespace {

using Memory = vk::MemoryPropertyFlagBits;

vk::raii::Buffer make_buffer(const Device& device, std::size_t bytes) {
    using Usage = vk::BufferUsageFlagBits;
    return {device.get(),
            vk::BufferCreateInfo(
                {}, bytes, Usage::eStorageBuffer | Usage::eTransferSrc | Usage::eTransferDst)};
}

vk::raii::DeviceMemory allocate(const Device& device, const vk::raii::Buffer& buffer,
                                const std::string& what, vk::MemoryPropertyFlags wanted,
                                vk::MemoryPropertyFlags others) {
    const vk::MemoryRequirements needs = buffer.getMemoryRequirements();
    try {
        vk::raii::DeviceMemory memory = device.allocate(needs, wanted, others);
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
      memory_(allocate(device, buffer_, what, Memory::eDeviceLocal, {})) {
}

// The memory is cached if there is such, as reading what is not is slow.
StagingBuffer::StagingBuffer(const Device& device, std::size_t bytes)
    : size_(bytes),
      buffer_(make_buffer(device, bytes)),
      memory_(allocate(device, buffer_, "transfers", Memory::eHostVisible | Memory::eHostCoherent,
                       Memory::eHostCached)),
      data_(static_cast<std::byte*>(memory_.mapMemory(0, VK_WHOLE_SIZE))) {
}

}  // namespace lightcull
