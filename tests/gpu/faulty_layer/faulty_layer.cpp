// A layer of Vulkan that makes devices fail on demand. The environment variable LIGHTCULL_FAULT is
// looked up at every call:
//   CALL RESULT AFTER   a call of that name gives that VkResult, but for the first AFTER calls
//   since
//                       the variable was set; vkWaitForFences does not before the device is done,
//                       vkEnumeratePhysicalDevices with result 0 (VK_SUCCESS) finds no device
//   hung 0 0            waits end by timeouts; one without a timeout, which would never end, ends
//                       the program, as does taking away what the device is at work on
//   NAME VALUE 0        devices have that limit or lack that feature: see restricted_properties(),
//                       restricted_features() and restricted_queues()

#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace {

// The next layer, or the driver, by the table that objects of one instance or device share. The
// functions of an instance are looked up when it is made: later the loader answers with the first
// layer's.
struct NextInstance {
    VkInstance instance;
    PFN_vkGetInstanceProcAddr get;
    std::map<std::string, PFN_vkVoidFunction> functions;
};
struct NextDevice {
    VkDevice device;
    PFN_vkGetDeviceProcAddr get;
};
std::mutex mutex;
std::map<void*, NextInstance> instances;
std::map<void*, NextDevice> devices;

template <typename Object>
void* table_of(Object object) {
    return *reinterpret_cast<void**>(object);
}

PFN_vkVoidFunction next_of_instance(void* table, const char* name) {
    const std::lock_guard lock(mutex);
    const NextInstance& next = instances.at(table);
    const auto found = next.functions.find(name);
    return found == next.functions.end() ? next.get(next.instance, name) : found->second;
}
PFN_vkVoidFunction next(VkPhysicalDevice device, const char* name) {
    return next_of_instance(table_of(device), name);
}
PFN_vkVoidFunction next(VkInstance instance, const char* name) {
    return next_of_instance(table_of(instance), name);
}
template <typename Object>  // Object: a device, or what belongs to one
PFN_vkVoidFunction next(Object object, const char* name) {
    const std::lock_guard lock(mutex);
    const NextDevice& found = devices.at(table_of(object));
    return found.get(found.device, name);
}
template <typename Function, typename Object>
Function next_as(Object object, const char* name) {
    return reinterpret_cast<Function>(next(object, name));
}

/// The number that LIGHTCULL_FAULT has for a name.
std::optional<int> fault(const std::string& wanted) {
    static std::string variable;
    static int calls = 0;
    const std::lock_guard lock(mutex);
    const char* set = std::getenv("LIGHTCULL_FAULT");
    if (set == nullptr) {
        variable.clear();
        return std::nullopt;
    }
    char name[64];
    int value = 0, after = 0;
    if (std::sscanf(set, "%63s %d %d", name, &value, &after) != 3) std::abort();
    if (variable != set) {
        variable = set;
        calls = 0;
    }
    if (wanted != name || calls++ < after) return std::nullopt;
    return value;
}

void end_if_hung(const char* what) {
    if (!fault("hung")) return;
    std::fprintf(stderr, "%s of a device that hangs\n", what);
    std::abort();
}

// ---- calls that fail

template <const auto& kName, typename Object, typename... Arguments>
VKAPI_ATTR VkResult VKAPI_CALL failing(Object object, Arguments... arguments) {
    if (const std::optional<int> result = fault(kName)) return static_cast<VkResult>(*result);
    return next_as<VkResult(VKAPI_PTR*)(Object, Arguments...)>(object, kName)(object, arguments...);
}

VKAPI_ATTR VkResult VKAPI_CALL wait_for_fences(VkDevice device, uint32_t count,
                                               const VkFence* fences, VkBool32 all,
                                               uint64_t timeout) {
    const auto wait = next_as<PFN_vkWaitForFences>(device, "vkWaitForFences");
    if (fault("hung")) {
        if (timeout == UINT64_MAX) end_if_hung("an endless wait");
        wait(device, count, fences, all, UINT64_MAX);  // what is freed after the wait may be in use
                                                       // no more
        return VK_TIMEOUT;
    }
    const std::optional<int> result = fault("vkWaitForFences");
    if (!result) return wait(device, count, fences, all, timeout);
    wait(device, count, fences, all, UINT64_MAX);
    return static_cast<VkResult>(*result);
}

template <const auto& kName, typename Object>
VKAPI_ATTR VkResult VKAPI_CALL waiting(Object object) {
    end_if_hung("an endless wait");
    return next_as<VkResult(VKAPI_PTR*)(Object)>(object, kName)(object);
}

template <const auto& kName, typename... Arguments>
VKAPI_ATTR void VKAPI_CALL freeing(VkDevice device, Arguments... arguments) {
    end_if_hung("the end");
    next_as<void(VKAPI_PTR*)(VkDevice, Arguments...)>(device, kName)(device, arguments...);
}

VKAPI_ATTR VkResult VKAPI_CALL enumerate_devices(VkInstance instance, uint32_t* count,
                                                 VkPhysicalDevice* found) {
    if (const std::optional<int> result = fault("vkEnumeratePhysicalDevices")) {
        *count = 0;
        return static_cast<VkResult>(*result);
    }
    return next_as<PFN_vkEnumeratePhysicalDevices>(instance, "vkEnumeratePhysicalDevices")(
        instance, count, found);
}

// ---- devices that can do less

VKAPI_ATTR void VKAPI_CALL restricted_properties(VkPhysicalDevice device,
                                                 VkPhysicalDeviceProperties* properties) {
    next_as<PFN_vkGetPhysicalDeviceProperties>(device, "vkGetPhysicalDeviceProperties")(device,
                                                                                        properties);
    VkPhysicalDeviceLimits& limits = properties->limits;
    const auto restrict_to = [](const char* name, uint32_t& limit) {
        if (const std::optional<int> value = fault(name)) limit = static_cast<uint32_t>(*value);
    };
    restrict_to("maxStorageBufferRange", limits.maxStorageBufferRange);
    restrict_to("maxComputeSharedMemorySize", limits.maxComputeSharedMemorySize);
    restrict_to("maxPerStageDescriptorStorageBuffers", limits.maxPerStageDescriptorStorageBuffers);
    if (fault("apiVersion")) properties->apiVersion = VK_API_VERSION_1_0;
}

VKAPI_ATTR void VKAPI_CALL restricted_features(VkPhysicalDevice device,
                                               VkPhysicalDeviceFeatures* features) {
    next_as<PFN_vkGetPhysicalDeviceFeatures>(device, "vkGetPhysicalDeviceFeatures")(device,
                                                                                    features);
    if (fault("shaderFloat64")) features->shaderFloat64 = VK_FALSE;
    if (fault("shaderInt64")) features->shaderInt64 = VK_FALSE;
}

VKAPI_ATTR void VKAPI_CALL restricted_queues(VkPhysicalDevice device, uint32_t* count,
                                             VkQueueFamilyProperties* families) {
    next_as<PFN_vkGetPhysicalDeviceQueueFamilyProperties>(
        device, "vkGetPhysicalDeviceQueueFamilyProperties")(device, count, families);
    if (families == nullptr || !fault("compute")) return;
    for (uint32_t i = 0; i < *count; ++i)
        families[i].queueFlags &= ~VkQueueFlags{VK_QUEUE_COMPUTE_BIT};
}

VKAPI_ATTR void VKAPI_CALL restricted_memory(VkPhysicalDevice device,
                                             VkPhysicalDeviceMemoryProperties* memory) {
    next_as<PFN_vkGetPhysicalDeviceMemoryProperties>(device, "vkGetPhysicalDeviceMemoryProperties")(
        device, memory);
    const std::optional<int> size = fault("heapSize");
    if (!size) return;
    for (uint32_t i = 0; i < memory->memoryHeapCount; ++i) {
        memory->memoryHeaps[i].size = static_cast<VkDeviceSize>(*size);
    }
}

// ---- the chain of layers

extern const std::map<std::string, PFN_vkVoidFunction> of_instances;

/// The link to the next layer in what vkCreateInstance and vkCreateDevice are given.
template <typename LayerInfo, typename CreateInfo>
LayerInfo* link_in(const CreateInfo* create, VkStructureType type) {
    auto* info = static_cast<LayerInfo*>(const_cast<void*>(create->pNext));
    while (info->sType != type || info->function != VK_LAYER_LINK_INFO) {
        info = static_cast<LayerInfo*>(const_cast<void*>(info->pNext));
    }
    return info;
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* create,
                                               const VkAllocationCallbacks* callbacks,
                                               VkInstance* instance) {
    if (const auto result = fault("vkCreateInstance")) return static_cast<VkResult>(*result);
    auto* link =
        link_in<VkLayerInstanceCreateInfo>(create, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
    const PFN_vkGetInstanceProcAddr get = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    const auto call = reinterpret_cast<PFN_vkCreateInstance>(get(nullptr, "vkCreateInstance"));
    const VkResult result = call(create, callbacks, instance);
    if (result != VK_SUCCESS) return result;
    NextInstance next{*instance, get, {}};
    for (const auto& own : of_instances) {
        next.functions[own.first] = get(*instance, own.first.c_str());
    }
    const std::lock_guard lock(mutex);
    instances[table_of(*instance)] = next;
    return VK_SUCCESS;
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical,
                                             const VkDeviceCreateInfo* create,
                                             const VkAllocationCallbacks* callbacks,
                                             VkDevice* device) {
    if (const auto result = fault("vkCreateDevice")) return static_cast<VkResult>(*result);
    auto* link =
        link_in<VkLayerDeviceCreateInfo>(create, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
    const PFN_vkGetDeviceProcAddr get = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    const PFN_vkGetInstanceProcAddr get_of_instance =
        link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    const auto call =
        reinterpret_cast<PFN_vkCreateDevice>(get_of_instance(nullptr, "vkCreateDevice"));
    const VkResult result = call(physical, create, callbacks, device);
    const std::lock_guard lock(mutex);
    if (result == VK_SUCCESS) devices[table_of(*device)] = {*device, get};
    return result;
}

template <typename Function>
PFN_vkVoidFunction untyped(Function* function) {
    return reinterpret_cast<PFN_vkVoidFunction>(function);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_function(VkInstance instance,
                                                               const char* name);
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_function(VkDevice device, const char* name);

#define NAME(call) constexpr char k##call[] = "vk" #call
NAME(AllocateMemory);
NAME(MapMemory);
NAME(CreateBuffer);
NAME(CreateComputePipelines);
NAME(QueueSubmit);
NAME(DeviceWaitIdle);
NAME(QueueWaitIdle);
NAME(FreeMemory);
NAME(DestroyBuffer);
NAME(DestroyPipeline);
NAME(DestroyDevice);
#undef NAME

#define FAILING(call) \
    { k##call, untyped(static_cast<PFN_vk##call>(&failing<k##call>)) }
#define WAITING(call) \
    { k##call, untyped(static_cast<PFN_vk##call>(&waiting<k##call>)) }
#define FREEING(call) \
    { k##call, untyped(static_cast<PFN_vk##call>(&freeing<k##call>)) }
const std::map<std::string, PFN_vkVoidFunction> of_devices{
    {"vkGetDeviceProcAddr", untyped(&get_device_function)},
    {"vkWaitForFences", untyped(&wait_for_fences)},
    FAILING(AllocateMemory),
    FAILING(MapMemory),
    FAILING(CreateBuffer),
    FAILING(CreateComputePipelines),
    FAILING(QueueSubmit),
    WAITING(DeviceWaitIdle),
    WAITING(QueueWaitIdle),
    FREEING(FreeMemory),
    FREEING(DestroyBuffer),
    FREEING(DestroyPipeline),
    FREEING(DestroyDevice),
};
#undef FAILING
#undef WAITING
#undef FREEING

const std::map<std::string, PFN_vkVoidFunction> of_instances{
    {"vkGetInstanceProcAddr", untyped(&get_instance_function)},
    {"vkCreateInstance", untyped(&create_instance)},
    {"vkCreateDevice", untyped(&create_device)},
    {"vkEnumeratePhysicalDevices", untyped(&enumerate_devices)},
    {"vkGetPhysicalDeviceProperties", untyped(&restricted_properties)},
    {"vkGetPhysicalDeviceFeatures", untyped(&restricted_features)},
    {"vkGetPhysicalDeviceQueueFamilyProperties", untyped(&restricted_queues)},
    {"vkGetPhysicalDeviceMemoryProperties", untyped(&restricted_memory)},
};

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_function(VkInstance instance,
                                                               const char* name) {
    for (const auto* own : {&of_instances, &of_devices}) {
        const auto found = own->find(name);
        if (found != own->end()) return found->second;
    }
    return instance == nullptr ? nullptr : next(instance, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_function(VkDevice device, const char* name) {
    const auto found = of_devices.find(name);
    return found == of_devices.end() ? next(device, name) : found->second;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* agreed) {
    agreed->loaderLayerInterfaceVersion = 2;
    agreed->pfnGetInstanceProcAddr = &get_instance_function;
    agreed->pfnGetDeviceProcAddr = &get_device_function;
    agreed->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
}
