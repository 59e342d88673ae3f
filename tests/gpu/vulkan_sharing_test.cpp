// These tests show samplers side by side, one sampler on several threads, and what a pass takes.

#include <doctest/doctest.h>
#include <lightcull/sampler_info.h>

#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "device_support.h"

using namespace lightcull;
using namespace lightcull::testing;

TEST_CASE("batches of several threads, each to its own sampler and all to one, are kept apart") {
    const auto lights = mixed_lights(300, 81);
    const auto cpu = make_sampler("culled:sets=4", lights);
    const auto shared = make_vulkan_sampler(make_sampler("culled:sets=4", lights));
    for (LightSampler* sampler : {cpu.get(), shared.get()}) sampler->begin_pass(4);
    constexpr std::size_t kThreads = 3;
    std::size_t different[kThreads] = {};
    std::vector<std::thread> threads;
    for (std::size_t thread = 0; thread < kThreads; ++thread) {
        threads.emplace_back([&, thread] {
            const auto own = make_vulkan_sampler(make_sampler("culled:sets=4", lights));
            own->begin_pass(4);
            for (std::uint64_t batch = 0; batch < 5; ++batch) {
                const auto points = mixed_points(400, 82 + 10 * thread + batch, 4);
                const std::vector<float> u(points.size(), 0.7f);
                std::vector<Selection> expected(points.size()), selected(points.size());
                cpu->select(points, u, expected);
                for (const LightSampler* sampler : {own.get(), shared.get()}) {
                    sampler->select(points, u, selected);
                    for (std::size_t i = 0; i < points.size(); ++i) {
                        different[thread] += selected[i].light == expected[i].light ? 0 : 1;
                    }
                }
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    for (const std::size_t of_thread : different) CHECK(of_thread <= 2);
}

TEST_CASE("samplers may end in any order") {
    auto first = make_vulkan_sampler(culled()), second = make_vulkan_sampler(culled());
    first->begin_pass(1);
    first.reset();
    second->begin_pass(1);
    auto third = make_vulkan_sampler(culled());
    third->begin_pass(1);
    CHECK(chosen_by(*second) == chosen_by(*third));
    third.reset();
    CHECK(!chosen_by(*second).empty());
}

TEST_CASE("passes and batches of any size take no more memory of the device") {
    const FaultyLayer layer;
    const auto gpu = make_vulkan_sampler(culled());
    const std::size_t size = sampler_info(*gpu)->memory_size();
    for (const char* call : {"vkAllocateMemory -2 ", "vkCreateBuffer -2 "}) {
        const Fault none_more(call);
        for (std::uint64_t pass = 0; pass < 20; ++pass) {
            CHECK(error_of([&] { gpu->begin_pass(pass); }).empty());
            chosen_by(*gpu);
        }
    }
    CHECK(sampler_info(*gpu)->memory_size() == size);  // it has not failed
}
