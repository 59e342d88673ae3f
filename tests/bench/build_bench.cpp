#include "benchmarks.h"
#include "registration.h"
#include "subject.h"

#include <lightcull/sampler_info.h>

#include <string>
#include <vector>

namespace lightcull::bench {
namespace {

constexpr int kThreads[] = {1, 2};

void build(benchmark::State& state, const std::string& sampler, std::uint32_t lights, int threads) {
    const auto scene = courtyard(lights);
    std::size_t bytes = 0;
    on_threads(threads, [&] {
        for ([[maybe_unused]] auto turn : state) {
            bytes = sampler_info(*make_scene_sampler(sampler, *scene, settings()))->memory_size();
        }
    });
    state.counters["bytes_per_light"] = static_cast<double>(bytes) / lights;
}

void refit(benchmark::State& state, std::uint32_t lights, int threads) {
    LightSampler& sampler = *subject("culled", lights).sampler;
    std::uint64_t pass = 0;
    on_threads(threads, [&] {
        for ([[maybe_unused]] auto turn : state) sampler.begin_pass(++pass);
    });
    using benchmark::Counter;
    state.counters["per_light_and_set"] =
        Counter(static_cast<double>(lights) * sampler.set_count(),
                Counter::kIsIterationInvariantRate | Counter::kInvert);
    state.counters["sets"] = sampler.set_count();
}

/// Lights that drift a little from frame to frame.
void update(benchmark::State& state, const std::string& description, std::uint32_t light_count,
            int threads) {
    const auto scene = courtyard(light_count);
    const auto sampler = make_scene_sampler(description, *scene, settings());
    std::vector<Light> lights(scene->lights().begin(), scene->lights().end());
    float growth = 0.0f;
    on_threads(threads, [&] {
        for ([[maybe_unused]] auto turn : state) {
            for (Light& light : lights) light.center.y += 1e-4f;
            growth = sampler->update(lights).growth;
        }
    });
    state.counters["growth"] = static_cast<double>(growth);
}

}  // namespace

void register_building(std::uint32_t light_count) {
    for (const int threads : kThreads) {
        const std::string setting = setting_name(light_count, threads);
        for (const char* sampler : {"light_bvh", "culled"}) {
            std::string name = "build/";
            add(name.append(sampler).append(setting),
                [=](benchmark::State& state) { build(state, sampler, light_count, threads); });
            name = "update/";
            add(name.append(sampler).append(setting),
                [=](benchmark::State& state) { update(state, sampler, light_count, threads); });
        }
        add("refit/culled" + setting,
            [=](benchmark::State& state) { refit(state, light_count, threads); });
    }
}

}  // namespace lightcull::bench
