#include "benchmarks.h"
#include "registration.h"
#include "subject.h"

#include "base/random.h"
#include "render/camera.h"
#include "render/scene_data.h"
#include "render/wavefront.h"

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

namespace lightcull::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Rays of one kind, by the calls that a render traces them with.
struct Recorded {
    std::vector<std::vector<Ray>> batches;
    std::size_t count = 0;

    void add(Span<const Ray> rays) {
        batches.emplace_back(rays.begin(), rays.end());
        count += rays.size();
    }
};

/// The rays of a pass.
struct PassRecord {
    Recorded camera, scattered, shadow;
};

PassRecord record(const Subject& subject, const RenderSettings& settings) {
    const SceneData& scene = data_of(*subject.scene);
    const CameraRays camera(subject.scene->camera(), settings.width, settings.height);
    std::vector<V3f> pixels(std::size_t{settings.width} * settings.height, V3f(0.0f));
    const Pass pass{scene,
                    settings,
                    PassRays(camera, settings, 0),
                    *subject.sampler,
                    nullptr,
                    0,
                    settings.seed,
                    settings.seed,
                    nullptr,
                    pixels.data(),
                    nullptr,
                    false};
    PassRecord rays;
    Wavefront wavefront;
    for (const Tile& tile : tiles_of({0, 0, settings.width, settings.height}, kTileSize)) {
        wavefront.start(pass, tile);
        Recorded* kind = &rays.camera;
        while (wavefront.advance()) {
            kind->add(wavefront.rays());
            kind = &rays.scattered;
            subject.sampler->select(wavefront.points(), wavefront.selection_numbers(),
                                    wavefront.selections());
            wavefront.shade();
            rays.shadow.add(wavefront.shadow_rays());
        }
        kind->add(wavefront.rays());
    }
    return rays;
}

/// The seconds that a loop takes which does nothing but trace such rays.
double replay(const RayTracer& tracer, const Recorded& rays, bool coherent) {
    std::vector<Hit> hits(std::size_t{kTileSize} * kTileSize);
    const Clock::time_point start = Clock::now();
    for (const std::vector<Ray>& batch : rays.batches) {
        tracer.intersect(batch, {hits.data(), batch.size()}, coherent);
    }
    return seconds_since(start);
}
double replay_shadow(const RayTracer& tracer, const Recorded& rays) {
    std::vector<std::uint8_t> occluded(std::size_t{kTileSize} * kTileSize);
    const Clock::time_point start = Clock::now();
    for (const std::vector<Ray>& batch : rays.batches) {
        tracer.occluded(batch, {occluded.data(), batch.size()});
    }
    return seconds_since(start);
}

/// Measures a pass of a render, and loops that trace the same rays and do nothing else, in turns:
/// seconds per ray of each, and the share of the pass that the rays take.
void render_pass(benchmark::State& state, std::uint32_t lights, std::uint32_t max_depth) {
    const Subject& s = subject("culled", lights);
    RenderSettings one_thread = settings();
    one_thread.max_depth = max_depth;
    one_thread.threads = 1;
    const PassRecord rays = record(s, one_thread);
    const RayTracer& tracer = *data_of(*s.scene).ray_tracer;
    Renderer renderer(s.scene, one_thread, make_scene_sampler("culled", *s.scene, one_thread));
    renderer.render_pass();
    const RenderStats before = renderer.stats();
    double camera = 0.0, scattered = 0.0, shadow = 0.0, turns = 0.0;
    for ([[maybe_unused]] auto turn : state) {
        renderer.render_pass();
        camera += replay(tracer, rays.camera, true);
        scattered += replay(tracer, rays.scattered, false);
        shadow += replay_shadow(tracer, rays.shadow);
        turns += 1.0;
    }
    const auto count = [](const Recorded& kind) { return static_cast<double>(kind.count); };
    const double all = count(rays.camera) + count(rays.scattered) + count(rays.shadow);
    const double of_render = (renderer.stats().seconds - before.seconds) /
                             static_cast<double>(renderer.stats().rays - before.rays);
    state.counters["render"] = of_render;
    state.counters["camera"] = camera / (turns * count(rays.camera));
    state.counters["scattered"] = scattered / (turns * count(rays.scattered));
    state.counters["shadow"] = shadow / (turns * count(rays.shadow));
    state.counters["rays_share"] = (camera + scattered + shadow) / (turns * all * of_render);
}

}  // namespace

void register_rays(std::uint32_t light_count) {
    for (const std::uint32_t max_depth : {2u, 4u}) {
        add("render_pass/depth:" + std::to_string(max_depth) + setting_name(light_count, 1),
            [=](benchmark::State& state) { render_pass(state, light_count, max_depth); });
    }
}

}  // namespace lightcull::bench
