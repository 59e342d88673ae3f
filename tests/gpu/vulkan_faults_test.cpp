// These tests show what is said when a device fails, and that the processor goes on. A layer of
// Vulkan makes calls fail: faulty_layer/faulty_layer.cpp.

#include <doctest/doctest.h>
#include <lightcull/sampler_info.h>

#include <string>

#include "device_support.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

/// Values of vk::Result, as the layer reads them.
constexpr const char *kOutOfHostMemory = " -1 ", *kOutOfDeviceMemory = " -2 ", *kFailed = " -3 ",
                     *kLost = " -4 ", *kTimeout = " 2 ";

std::string set_up_error(const std::string& call_and_value, int after = 0,
                         const std::string& description = "culled:sets=4") {
    const Fault fault(call_and_value, after);
    return error_of([&] { make_vulkan_sampler(make_sampler(description, mixed_lights(500, 75))); });
}

void check_that_devices_work() {
    const auto cpu = culled(), gpu = make_vulkan_sampler(culled());
    for (LightSampler* sampler : {cpu.get(), gpu.get()}) sampler->begin_pass(1);
    const auto a = chosen_by(*gpu), b = chosen_by(*cpu);
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.size(); ++i) different += a[i] == b[i] ? 0 : 1;
    CHECK(different <= 2);  // ties, of 1,000 selections
}

/// Checks that a fault in a pass is told by an Error that ends with `told`, once, and that the
/// processor goes on, whether the fault lasts or not.
void check_fault(const std::string& call_and_value, const std::string& told) {
    CAPTURE(call_and_value);
    const auto cpu = culled();
    const auto in_refit = make_vulkan_sampler(culled()), in_select = make_vulkan_sampler(culled());
    cpu->begin_pass(1);
    in_select->begin_pass(1);
    const auto is_told = [&](LightSampler& sampler, std::uint64_t pass) {
        const std::string error = error_of([&] { sampler.begin_pass(pass); });
        return contains(error, "Vulkan device '") && contains(error, told);
    };
    {
        const Fault fault(call_and_value);
        CHECK(is_told(*in_refit, 1));
        CHECK(chosen_by(*in_refit) == chosen_by(*cpu));
        CHECK(chosen_by(*in_select) == chosen_by(*cpu));
        cpu->begin_pass(2);
        CHECK(is_told(*in_select, 2));
        CHECK(chosen_by(*in_select) == chosen_by(*cpu));
    }
    cpu->begin_pass(3);
    for (LightSampler* sampler : {in_refit.get(), in_select.get()}) {
        CHECK(error_of([&] { sampler->begin_pass(3); }).empty());
        CHECK(chosen_by(*sampler) == chosen_by(*cpu));
        CHECK(sampler_info(*sampler)->memory_size() == sampler_info(*cpu)->memory_size());
    }
    check_that_devices_work();
}

}  // namespace

TEST_CASE("a device that is lost is told once, and the processor goes on") {
    const FaultyLayer layer;
    for (const std::string call : {"vkQueueSubmit", "vkWaitForFences"}) {
        check_fault(call + kLost, "': the device was lost");
        CHECK(contains(set_up_error(call + kLost), "': the device was lost"));
    }
    CHECK(set_up_error(std::string("vkCreateDevice") + kLost) == "Vulkan: the device was lost");
}

TEST_CASE("a device that is out of memory is told once, and the processor goes on") {
    const FaultyLayer layer;
    check_fault(std::string("vkQueueSubmit") + kOutOfDeviceMemory, "': out of device memory");
    check_fault(std::string("vkQueueSubmit") + kOutOfHostMemory, "': out of memory");
}

TEST_CASE("set-up without enough memory names what it was for, wherever it stops") {
    const FaultyLayer layer;
    const std::string call = "vkAllocateMemory";
    CHECK(contains(set_up_error(call + kOutOfDeviceMemory),
                   " bytes for sphere nodes: out of device memory"));
    CHECK(
        contains(set_up_error(call + kOutOfHostMemory), " bytes for sphere nodes: out of memory"));
    int allocations = 0;
    while (!set_up_error(call + kOutOfDeviceMemory, allocations).empty()) ++allocations;
    CHECK(allocations == 14);
    CHECK(contains(set_up_error(call + kOutOfDeviceMemory, allocations - 1),
                   " bytes for transfers: "));
    CHECK(contains(set_up_error("heapSize 100 "), "bytes for sphere nodes: out of device memory"));
    for (const std::string other :
         {"vkMapMemory", "vkCreateBuffer", "vkCreateComputePipelines", "vkCreateDevice"}) {
        CHECK(set_up_error(other + kOutOfHostMemory) == "Vulkan: out of memory");
        CHECK(set_up_error(other + kOutOfDeviceMemory) == "Vulkan: out of device memory");
    }
    check_that_devices_work();
}

TEST_CASE("a device that does not answer in time is told once, and the processor goes on") {
    const FaultyLayer layer;
    check_fault(std::string("vkWaitForFences") + kTimeout, "': no answer within 60 s");
    CHECK(contains(set_up_error(std::string("vkWaitForFences") + kTimeout),
                   "': no answer within 60 s"));
}

TEST_CASE("a device that never answers holds up nothing, not even the end") {
    const FaultyLayer layer;
    CHECK(contains(set_up_error("hung 0 "), "': no answer within 60 s"));
    check_fault("hung 0 ", "': no answer within 60 s");
}

TEST_CASE("devices that cannot be used are told, each with its problem") {
    const FaultyLayer layer;
    const std::string name = vulkan_devices().front().name;
    struct {
        std::string fault, problem;
    } const cases[] = {
        {"compute 0 ", "no queue for compute"},
        {"apiVersion 0 ", "older than Vulkan 1.1"},
        {"shaderFloat64 0 ", "no 64-bit floats"},
        {"shaderInt64 0 ", "no 64-bit integers"},
        {"maxPerStageDescriptorStorageBuffers 7 ", "too few storage buffers for a shader"},
    };
    for (const auto& [call_and_value, problem] : cases) {
        std::string told = name;
        told.append(": ").append(problem);
        CHECK(
            contains(set_up_error(call_and_value), "Vulkan: no device that can be used (" + told));
        const Fault fault(call_and_value);
        CHECK(vulkan_devices().front().problem == problem);
    }
    check_that_devices_work();
}

TEST_CASE("a driver without devices, or one that fails, is an error") {
    const FaultyLayer layer;
    const auto errors = [](const std::string& call_and_value) {
        const Fault fault(call_and_value + "0");
        return error_of([] { vulkan_devices(); });
    };
    const std::string none = "Vulkan: this machine has a driver for it, but no device";
    CHECK(errors("vkEnumeratePhysicalDevices 0 ") == none);
    CHECK(set_up_error("vkEnumeratePhysicalDevices 0 ") == none);
    const std::string enumerate = std::string("vkEnumeratePhysicalDevices") + kFailed;
    CHECK(errors(enumerate).find("Vulkan: the list of devices: ") == 0);
    CHECK(set_up_error(enumerate).find("Vulkan: the list of devices: ") == 0);
    const std::string create = std::string("vkCreateInstance") + kFailed;
    CHECK(errors(create).find("Vulkan: no instance of it: ") == 0);
    CHECK(set_up_error(create).find("Vulkan: no instance of it: ") == 0);
    CHECK(set_up_error(std::string("vkCreateDevice") + kFailed).find("Vulkan: ") == 0);
    check_that_devices_work();
}

TEST_CASE("scenes and lists that are more than a device takes are told") {
    const FaultyLayer layer;
    CHECK(contains(set_up_error("maxStorageBufferRange 100 "), "': sphere nodes take "));
    CHECK(contains(set_up_error("maxStorageBufferRange 100 "),
                   " bytes, more than the 100 of a buffer"));
    CHECK(contains(set_up_error("maxComputeSharedMemorySize 16384 ", 0, "paper:list=64"),
                   "': the lists of a workgroup take "));
    CHECK(set_up_error("maxComputeSharedMemorySize 16384 ", 0, "paper").empty());
}
