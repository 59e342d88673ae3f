#pragma once

#include <lightcull/render/renderer.h>

#include <tbb/task_arena.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// The things that are measured. Making one takes longer than measuring it, so the one that was
/// asked for last is kept.

namespace lightcull::bench {

/// The kinds of places that points come from.
enum class PointKind { kCamera, kBounce1, kBounce2, kUniform };

/// The scene of so many lights.
std::shared_ptr<const Scene> courtyard(std::uint32_t light_count);

/// Settings of 640 x 480 pixels and two bounces.
RenderSettings settings();

/// A sampler over a courtyard.
struct Subject {
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<LightSampler> sampler;
};
Subject& subject(const std::string& description, std::uint32_t light_count);

/// Points with the sets of a sampler, as the renderer would have them, and random numbers.
struct Points {
    std::vector<ShadingPoint> points;
    std::vector<float> u;
};
Points make_points(const Subject& subject, PointKind kind);

/// Runs `action` on so many threads.
template <typename Action>
void on_threads(int threads, const Action& action) {
    tbb::task_arena arena(threads);
    arena.execute(action);
}

}  // namespace lightcull::bench
