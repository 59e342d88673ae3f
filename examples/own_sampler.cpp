/// A light sampler of one's own in C++, for lightcull.SamplerLibrary: it chooses lights uniformly.
///
///     c++ -std=c++17 -O2 -shared -fPIC -I core/include examples/own_sampler.cpp -o libmine.so
///     lightcull.compare(scene, {"mine": lightcull.SamplerLibrary("libmine.so")}, seconds=10)
///
/// It defines functions of the C interface in its own way; nothing of lightcull is linked.

#include <lightcull/lightcull.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>

struct lightcull_sampler {
    uint32_t light_count;
};

namespace {

/// A sampler without passes of its own is its only pass.
const lightcull_sampler* sampler_of(const lightcull_pass* pass) {
    return reinterpret_cast<const lightcull_sampler*>(pass);
}

}  // namespace

const char* lightcull_last_error(void) {
    return "there is no memory";
}

lightcull_error lightcull_sampler_create(const char*, const lightcull_light*, size_t count,
                                         const lightcull_context*, lightcull_sampler** sampler) {
    *sampler = new (std::nothrow) lightcull_sampler{static_cast<uint32_t>(count)};
    return *sampler != nullptr ? LIGHTCULL_OK : LIGHTCULL_OUT_OF_MEMORY;
}

void lightcull_sampler_destroy(lightcull_sampler* sampler) {
    delete sampler;
}

lightcull_error lightcull_sampler_begin_pass(lightcull_sampler*, uint64_t) {
    return LIGHTCULL_OK;
}

const lightcull_pass* lightcull_sampler_current_pass(const lightcull_sampler* sampler) {
    return reinterpret_cast<const lightcull_pass*>(sampler);
}

uint32_t lightcull_set_count(const lightcull_pass*) {
    return 1;
}

int lightcull_needs_receipt(const lightcull_pass*) {
    return 0;
}

lightcull_error lightcull_select_many(const lightcull_pass* pass, const lightcull_shading_point*,
                                      const float* u, size_t count,
                                      lightcull_selection* selections) {
    const uint32_t lights = sampler_of(pass)->light_count;
    for (size_t i = 0; i < count; ++i) {
        const auto light = static_cast<uint32_t>(u[i] * static_cast<float>(lights));
        const float prob = lights > 0 ? 1.0f / static_cast<float>(lights) : 0.0f;
        selections[i] = {std::min(light, lights - 1), prob, prob, {0.0f, 0}};
    }
    return LIGHTCULL_OK;
}

float lightcull_prob(const lightcull_pass* pass, const lightcull_shading_point*,
                     const lightcull_receipt*, uint32_t) {
    return 1.0f / static_cast<float>(sampler_of(pass)->light_count);
}
