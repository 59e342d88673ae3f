#pragma once

#include <lightcull/span.h>

#include <cstdint>
#include <vector>

#include "gpu/buffer.h"

namespace lightcull {

/// A compute shader and the buffers that it works on.
class Kernel {
  public:
    /// code: SPIR-V. buffers: those of bindings 0 and following, which have to outlive the kernel.
    /// constants: the specialization constants 0 and following. Throws Error.
    Kernel(const Device& device, Span<const std::uint32_t> code,
           const std::vector<const Buffer*>& buffers, std::size_t push_size,
           const std::vector<std::uint32_t>& constants);

    template <typename Push>
    void dispatch(const vk::raii::CommandBuffer& commands, const Push& push,
                  std::uint32_t workgroups) const {
        commands.pushConstants<Push>(*layout_, vk::ShaderStageFlagBits::eCompute, 0, push);
        dispatch(commands, workgroups);
    }

  private:
    void dispatch(const vk::raii::CommandBuffer& commands, std::uint32_t workgroups) const;

    vk::raii::DescriptorSetLayout set_layout_;
    vk::raii::DescriptorPool pool_;
    vk::raii::DescriptorSet set_;
    vk::raii::PipelineLayout layout_;
    vk::raii::Pipeline pipeline_;
};

}  // namespace lightcull
