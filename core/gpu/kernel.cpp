#include "gpu/kernel.h"

#include <utility>

namespace lightcull {
namespace {

vk::raii::DescriptorSetLayout make_set_layout(const Device& device, std::size_t buffers) {
    std::vector<vk::DescriptorSetLayoutBinding> bindings;
    for (std::uint32_t i = 0; i < buffers; ++i) {
        bindings.emplace_back(i, vk::DescriptorType::eStorageBuffer, 1,
                              vk::ShaderStageFlagBits::eCompute);
    }
    return {device.get(), vk::DescriptorSetLayoutCreateInfo({}, bindings)};
}

vk::raii::DescriptorPool make_pool(const Device& device, std::size_t buffers) {
    const vk::DescriptorPoolSize size(vk::DescriptorType::eStorageBuffer,
                                      static_cast<std::uint32_t>(buffers));
    return {device.get(), vk::DescriptorPoolCreateInfo(
                              vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, size)};
}

vk::raii::PipelineLayout make_layout(const Device& device, vk::DescriptorSetLayout set_layout,
                                     std::size_t push_size) {
    const vk::PushConstantRange push(vk::ShaderStageFlagBits::eCompute, 0,
                                     static_cast<std::uint32_t>(push_size));
    return {device.get(), vk::PipelineLayoutCreateInfo({}, set_layout, push)};
}

vk::raii::Pipeline make_pipeline(const Device& device, vk::PipelineLayout layout,
                                 Span<const std::uint32_t> code,
                                 const std::vector<std::uint32_t>& constants) {
    const vk::raii::ShaderModule module(
        device.get(),
        vk::ShaderModuleCreateInfo({}, code.size() * sizeof(std::uint32_t), code.data()));
    std::vector<vk::SpecializationMapEntry> entries;
    constexpr std::uint32_t kSize = sizeof(std::uint32_t);
    for (std::uint32_t i = 0; i < constants.size(); ++i) {
        entries.emplace_back(i, i * kSize, kSize);
    }
    const vk::SpecializationInfo special(static_cast<std::uint32_t>(entries.size()), entries.data(),
                                         constants.size() * kSize, constants.data());
    const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module,
                                                  "main", &special);
    return {device.get(), nullptr, vk::ComputePipelineCreateInfo({}, stage, layout)};
}

}  // namespace

Kernel::Kernel(const Device& device, Span<const std::uint32_t> code,
               const std::vector<const Buffer*>& buffers, std::size_t push_size,
               const std::vector<std::uint32_t>& constants)
    : set_layout_(make_set_layout(device, buffers.size())),
      pool_(make_pool(device, buffers.size())),
      set_(std::move(vk::raii::DescriptorSets(
          device.get(), vk::DescriptorSetAllocateInfo(*pool_, *set_layout_))[0])),
      layout_(make_layout(device, *set_layout_, push_size)),
      pipeline_(make_pipeline(device, *layout_, code, constants)) {
    for (std::uint32_t i = 0; i < buffers.size(); ++i) {
        const vk::DescriptorBufferInfo buffer(buffers[i]->get(), 0, VK_WHOLE_SIZE);
        device.get().updateDescriptorSets(
            vk::WriteDescriptorSet(*set_, i, 0, vk::DescriptorType::eStorageBuffer, {}, buffer),
            {});
    }
}

void Kernel::dispatch(const vk::raii::CommandBuffer& commands, std::uint32_t workgroups) const {
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline_);
    commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *layout_, 0, *set_, {});
    commands.dispatch(workgroups, 1, 1);
}

}  // namespace lightcull
