#pragma once

#include <lightcull/light.h>
#include <lightcull/light_sampler.h>
#include <lightcull/sampler_info.h>
#include <lightcull/span.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/float3_math.h"
#include "base/random.h"

/// Lights and points that several tests share, all from fixed seeds.

namespace lightcull::testing {

inline float3 random_in_box(RandomStream& random, float half_extent) {
    const float x = random.next(), y = random.next(), z = random.next();
    return (float3{x, y, z} * 2.0f - float3{1, 1, 1}) * half_extent;
}

inline float3 random_direction(RandomStream& random) {
    for (;;) {
        const float3 v = random_in_box(random, 1.0f);
        const float l = length(v);
        if (l > 0.1f && l <= 1.0f) return v * (1.0f / l);
    }
}

/// Triangles (also two-sided), points and spots in a cube of 2 m, intensities over e^(spread).
inline std::vector<Light> mixed_lights(std::uint32_t count, std::uint64_t seed,
                                       float spread = 3.0f) {
    RandomStream random(seed);
    std::vector<Light> lights;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float3 a = random_in_box(random, 1.0f);
        const float3 d = random_direction(random), e = random_direction(random);
        const float intensity = std::exp(spread * random.next());
        const Light triangle =
            triangle_light(a, a + d * 0.1f, a + e * 0.1f, intensity * 100.0f, i % 5 == 2);
        switch (i % 5) {
            case 0:
                lights.push_back(point_light(a, intensity));
                break;
            case 1:
                lights.push_back(spot_light(a, d, intensity, 0.4f, 0.9f));
                break;
            default:
                lights.push_back(triangle);
        }
    }
    return lights;
}

/// The lights with a directional one, from anywhere and as strong, in place of each `every`-th.
inline std::vector<Light> with_suns(std::vector<Light> lights, std::size_t every) {
    RandomStream random(4);
    for (std::size_t i = every / 2; i < lights.size(); i += every) {
        lights[i] = directional_light(random_direction(random), lights[i].intensity);
    }
    return lights;
}

inline GlossyLobe random_lobe(RandomStream& random) {
    const float3 axis = random_direction(random);
    const float alpha = std::exp(-5.0f * random.next());
    return {axis * (1.0f / length(axis)), alpha, 10.0f * random.next()};
}

/// Points with and without normals and glossy lobes.
inline std::vector<ShadingPoint> mixed_points(std::uint32_t count, std::uint64_t seed,
                                              std::uint32_t set_count, float half_extent = 1.2f) {
    RandomStream random(seed);
    std::vector<ShadingPoint> points;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float3 x = random_in_box(random, half_extent);
        const float3 n = i % 4 == 3 ? float3{0, 0, 0} : random_direction(random);
        points.push_back({x, n, static_cast<std::uint32_t>(hash(i, seed) % set_count)});
        if (i % 3 == 1) points.back().lobe = random_lobe(random);
    }
    return points;
}

/// The two-sided quantile of the normal distribution that `tests` independent z-scores together
/// exceed with a probability of `false_alarms` (Sidak).
inline double sidak_z(double false_alarms, double tests) {
    const double each = -std::expm1(std::log1p(-false_alarms) / tests);
    double low = 0.0, high = 20.0;
    for (int i = 0; i < 100; ++i) {
        const double z = 0.5 * (low + high);
        (std::erfc(z / std::sqrt(2.0)) > each ? low : high) = z;
    }
    return high;
}

/// How many lights a sampler accepts at a point, in the mean over points and so many passes.
inline double accepted_per_point(LightSampler& sampler, Span<const ShadingPoint> points,
                                 std::uint64_t passes) {
    double sum = 0.0;
    for (std::uint64_t pass = 0; pass < passes; ++pass) {
        sampler.begin_pass(pass);
        for (const ShadingPoint& point : points)
            sum += sampler_info(sampler)->count(point).accepted;
    }
    return sum / (static_cast<double>(passes) * static_cast<double>(points.size()));
}

}  // namespace lightcull::testing
