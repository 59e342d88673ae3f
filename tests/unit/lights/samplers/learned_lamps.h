#pragma once

#include <lightcull/light_sampler.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/random.h"

namespace lightcull {

/// Lamps under a ceiling, of which a wall at x = 0 hides those on the other side.
inline std::vector<Light> lamps(int count = 600) {
    std::vector<Light> lights;
    RandomStream random(7);
    for (int i = 0; i < count; ++i) {
        const float3 at{8.0f * random.next() - 4.0f, 3.0f, 8.0f * random.next() - 4.0f};
        lights.push_back(point_light(at, 0.1f + random.next()));
    }
    return lights;
}

inline std::vector<ShadingPoint> floor_points(std::size_t count) {
    std::vector<ShadingPoint> points(count);
    RandomStream random(11);
    for (ShadingPoint& point : points) {
        point.position = {8.0f * random.next() - 4.0f, 0.0f, 8.0f * random.next() - 4.0f};
        point.normal = {0, 1, 0};
    }
    return points;
}

inline bool visible(const ShadingPoint& point, const Light& light) {
    return (point.position.x < 0.0f) == (light.center.x < 0.0f);
}

/// What the light gives the point but for visibility.
inline double given(const ShadingPoint& point, const Light& light) {
    const double x = double{light.center.x} - double{point.position.x};
    const double y = double{light.center.y} - double{point.position.y};
    const double z = double{light.center.z} - double{point.position.z};
    const double d2 = x * x + y * y + z * z;
    return double{light.intensity} * y / (d2 * std::sqrt(d2));
}

inline std::vector<float> numbers(std::size_t count, std::uint64_t key) {
    std::vector<float> u(count);
    RandomStream random(key);
    for (float& number : u) number = random.next();
    return u;
}

/// Selects at the points by the numbers of a pass, and says what became of it; truthful: false says
/// that what is visible is hidden, and the other way round.
inline std::vector<LightOutcome> outcomes_of(const LightSampler& sampler,
                                             const std::vector<Light>& lights,
                                             const std::vector<ShadingPoint>& points,
                                             std::uint64_t pass, bool truthful = true) {
    std::vector<Selection> selections(points.size());
    sampler.select(points, numbers(points.size(), pass), selections);
    std::vector<LightOutcome> outcomes;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!(selections[i].prob > 0.0f)) continue;
        const bool seen = visible(points[i], lights[selections[i].light]) == truthful;
        outcomes.push_back({points[i].position, points[i].normal, selections[i].receipt,
                            selections[i].light, seen ? 1.0f : 0.0f});
    }
    return outcomes;
}

/// Goes through the passes from one to before another, and begins that. Reports are in the order of
/// the points or against it.
inline void teach(LightSampler& sampler, const std::vector<Light>& lights,
                  const std::vector<ShadingPoint>& points, std::uint64_t first, std::uint64_t end,
                  bool truthful = true, bool backwards = false) {
    for (std::uint64_t pass = first; pass < end; ++pass) {
        sampler.begin_pass(pass);
        auto outcomes = outcomes_of(sampler, lights, points, pass, truthful);
        if (backwards) std::reverse(outcomes.begin(), outcomes.end());
        sampler.report(outcomes);
    }
    sampler.begin_pass(end);
}

inline bool select_alike(const LightSampler& a, const LightSampler& b,
                         const std::vector<ShadingPoint>& points) {
    const std::vector<float> u = numbers(points.size(), 99);
    std::vector<Selection> of_a(points.size()), of_b(points.size());
    a.select(points, u, of_a);
    b.select(points, u, of_b);
    return std::equal(
        of_a.begin(), of_a.end(), of_b.begin(), [](const Selection& x, const Selection& y) {
            return x.light == y.light && x.prob == y.prob &&
                   x.receipt.weight_sum == y.receipt.weight_sum && x.receipt.key == y.receipt.key;
        });
}

}  // namespace lightcull
