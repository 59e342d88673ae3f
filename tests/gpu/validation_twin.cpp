// Breaks a rule of Vulkan, for the validation layer to find: shows that it is at work in the tests.

#include <vulkan/vulkan_raii.hpp>

int main() {
    const vk::raii::Context context;
    const vk::ApplicationInfo application("twin", 1, nullptr, 0, VK_API_VERSION_1_1);
    const vk::raii::Instance instance(context, vk::InstanceCreateInfo({}, &application));
    const vk::raii::PhysicalDevices devices(instance);
    const float priority = 1.0f;
    const vk::DeviceQueueCreateInfo queue({}, 0, 1, &priority);
    const vk::raii::Device device(devices[0], vk::DeviceCreateInfo({}, queue));
    // A buffer of no bytes.
    const vk::raii::Buffer buffer(
        device, vk::BufferCreateInfo({}, 0, vk::BufferUsageFlagBits::eStorageBuffer));
}
