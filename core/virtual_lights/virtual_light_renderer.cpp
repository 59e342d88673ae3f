#include <lightcull/virtual_lights/virtual_light_renderer.h>

#include "base/memory_size.h"
#include "base/random.h"
#include "render/camera.h"
#include "render/film.h"
#include "render/scene_data.h"
#include "virtual_lights/grid/grid_lighting.h"
#include "virtual_lights/maps/imperfect_shadow_maps.h"
#include "virtual_lights/maps/point_cloud.h"
#include "virtual_lights/paths/light_paths.h"
#include "virtual_lights/scene_checks.h"
#include "virtual_lights/stopwatch.h"
#include "virtual_lights/tiles/tiled_lighting.h"
#include "virtual_lights/view/camera_view.h"
#include "virtual_lights/view/cross_bilateral.h"
#include "virtual_lights/volumes/volume_calibration.h"

#include <lightcull/error.h>

#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace lightcull {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

int thread_count(std::uint32_t wanted) {
    const int available = tbb::info::default_concurrency();
    return wanted == 0 ? available : std::min(static_cast<int>(wanted), available);
}

void check_depth(const RenderSettings& settings) {
    if (settings.max_depth < 3 || settings.max_depth > 5) {
        throw Error("virtual lights: max_depth is " + std::to_string(settings.max_depth) +
                    ", wanted 3 to 5: one to three bounces");
    }
}

VirtualLightStats& operator+=(VirtualLightStats& sum, const VirtualLightStats& pass) noexcept {
    sum.lights += pass.lights;
    sum.generation_seconds += pass.generation_seconds;
    sum.build_seconds += pass.build_seconds;
    sum.lighting_seconds += pass.lighting_seconds;
    sum.filter_seconds += pass.filter_seconds;
    sum.pixels += pass.pixels;
    sum.listed += pass.listed;
    sum.accepted += pass.accepted;
    sum.shadow_rays += pass.shadow_rays;
    sum.map_points += pass.map_points;
    return sum;
}

void note(const LightingCounts& counts, VirtualLightStats& cost) noexcept {
    cost.listed = counts.listed;
    cost.accepted = counts.accepted;
    cost.shadow_rays = counts.shadow_rays;
    cost.map_points = counts.map_points;
    cost.build_seconds = counts.build_seconds;
}

/// The bytes of a pixel that are kept, or worked with in a pass.
constexpr std::size_t kBytesPerPixel = sizeof(Surface) + sizeof(std::uint8_t) + 3 * sizeof(V3f) +
                                       sizeof(Imath::V3d) + 2 * sizeof(LightsOfPixel);

/// The bytes that a virtual light takes when most of it is there. For kGrid they are those where no
/// two lights share a cell of the finest grid (a third of it has been seen where many do).
std::size_t bytes_per_light(const VirtualLightOptions& options) noexcept {
    constexpr std::size_t kOfTiles = 280, kOfGrid = 1900;
    const bool maps = options.shadows == VirtualShadows::kMaps;
    return (options.method == VirtualLightMethod::kGrid ? kOfGrid : kOfTiles) +
           (maps ? ImperfectShadowMaps::kBytesPerLight : 0);
}

RenderSettings direct_only(RenderSettings settings) {
    settings.max_depth = 2;
    return settings;
}

}  // namespace

struct VirtualLightRenderer::Impl {
    std::shared_ptr<const Scene> shared_scene;
    RenderSettings settings;
    VirtualLightOptions options;
    Renderer direct;
    CameraRays camera;
    tbb::task_arena arena;
    EmissionTable emission;
    std::optional<RandomRanges> ranges;  ///< present since the first pass
    PointCloud cloud;                    ///< points for shadows by maps
    std::vector<LightsOfPixel> of_pixels;
    Film bounced;
    double seconds = 0.0;    ///< time for bounced light
    std::uint64_t rays = 0;  ///< camera and shadow rays of bounced light
    VirtualLightStats stats;

    Impl(std::shared_ptr<const Scene> s, const RenderSettings& r, const VirtualLightOptions& o,
         std::unique_ptr<LightSampler> sampler)
        : shared_scene(std::move(s)),
          settings(r),
          options(o),
          direct(shared_scene, direct_only(r), std::move(sampler)),
          camera(shared_scene->camera(), r.width, r.height),
          arena(thread_count(r.threads)),
          emission(data_of(*shared_scene)),
          of_pixels(std::size_t{r.width} * r.height),
          bounced(of_pixels.size()) {
        // The parts are so many that the maps of a few lights together have all of the geometry.
        constexpr std::uint32_t kParts = 16;
        if (options.shadows != VirtualShadows::kMaps) return;
        cloud = PointCloud(scene(), kParts, options.map_points, 0);
    }

    const SceneData& scene() const noexcept { return data_of(*shared_scene); }
    std::vector<LightRay> light_rays(std::uint32_t paths, std::uint64_t key) const;
    std::size_t bytes_of_lights() const;
    std::vector<VirtualLight> generate(std::uint64_t key, VirtualLightStats& cost) const;
    void begin_ranges(const std::vector<VirtualLight>& lights, std::uint64_t pass);
    std::vector<V3f> bounced_light(const std::atomic<bool>* cancel, VirtualLightStats& cost,
                                   std::vector<LightsOfPixel>& of_pass);
    void add_by_tiles(const LightingPass& lighting, const std::vector<VirtualLight>& lights,
                      std::vector<V3f>& pixels, VirtualLightStats& cost) const;
    void add_by_grid(const LightingPass& lighting, const std::vector<VirtualLight>& lights,
                     std::vector<V3f>& pixels, VirtualLightStats& cost) const;
};

/// The first rays of that many light paths, or of as many texels of each shadow map.
std::vector<LightRay> VirtualLightRenderer::Impl::light_rays(std::uint32_t paths,
                                                             std::uint64_t key) const {
    if (options.source == VirtualLightSource::kPaths) return emit(emission, paths, key);
    const double edge = std::sqrt(static_cast<double>(paths));
    return shadow_map_rays(scene(), emission, static_cast<std::uint32_t>(std::lround(edge)), key);
}

std::vector<VirtualLight> VirtualLightRenderer::Impl::generate(std::uint64_t key,
                                                               VirtualLightStats& cost) const {
    const Stopwatch watch;
    const std::vector<LightRay> starts = light_rays(options.light_paths, key);
    std::vector<VirtualLight> lights = virtual_lights(scene(), starts, settings.max_depth - 2, key);
    cost.lights = lights.size();
    cost.generation_seconds = watch.seconds();
    return lights;
}

/// The bytes of lights, estimated by a sample of the light paths.
std::size_t VirtualLightRenderer::Impl::bytes_of_lights() const {
    constexpr std::size_t kSample = 4096;
    std::size_t paths = kSample;
    if (options.source == VirtualLightSource::kShadowMap) {
        paths /= std::clamp<std::size_t>(scene().emitters.size(), 1, kSample);
        const auto edge = static_cast<std::size_t>(std::sqrt(static_cast<double>(paths)));
        paths = edge * edge;
    }
    const auto sample = std::min(options.light_paths, static_cast<std::uint32_t>(paths));
    const std::vector<LightRay> rays = light_rays(sample, 0);
    const std::size_t lights =
        virtual_lights(scene(), rays, settings.max_depth - 2, 0).size() * bytes_per_light(options);
    const double scale = static_cast<double>(options.light_paths) / sample;
    return static_cast<std::size_t>(scale * static_cast<double>(size_of(rays) + lights)) +
           cloud.memory_size();
}

/// Begins the ranges of a pass. The reach stays what the first pass's lights give: were it to
/// follow those of each pass, the error would depend on them.
void VirtualLightRenderer::Impl::begin_ranges(const std::vector<VirtualLight>& lights,
                                              std::uint64_t pass) {
    if (!ranges) {
        const bool constant = options.method == VirtualLightMethod::kClamped;
        const float reach = options.method == VirtualLightMethod::kAll
                                ? 1.0f
                                : calibrate_reach(lights, options, *shared_scene, settings);
        // The formulas are [TH16] Eq. 6 and appendix A.
        const double share = constant ? static_cast<double>(lights.size()) : 0.5;
        stats.error_bound = static_cast<double>(options.range.exposure) * share /
                            (static_cast<double>(kPi) * static_cast<double>(reach));
        ranges.emplace(reach, 1, constant ? RangeLaw::kConstant : RangeLaw::kRandom);
    }
    ranges->begin_pass(mix(settings.seed) + pass);
}

std::vector<V3f> VirtualLightRenderer::Impl::bounced_light(const std::atomic<bool>* cancel,
                                                           VirtualLightStats& cost,
                                                           std::vector<LightsOfPixel>& of_pass) {
    const std::uint64_t pass = direct.stats().passes;
    const PassRays camera_rays(camera, settings, pass);
    const CameraView view = trace_camera_view(scene(), settings, camera_rays);
    cost.pixels = static_cast<std::uint64_t>(std::count(view.hit.begin(), view.hit.end(), 1));
    const std::uint64_t key = hash(settings.seed, pass, std::uint64_t{0x6c6967687473});
    const std::vector<VirtualLight> lights = generate(key, cost);

    std::vector<V3f> pixels(view.hit.size(), V3f(0.0f));
    if (lights.empty()) return pixels;
    const LightingPass lighting{
        *scene().ray_tracer, camera, view, options, key, cancel, &cloud, of_pass};
    if (options.method == VirtualLightMethod::kGrid) {
        add_by_grid(lighting, lights, pixels, cost);
    } else {
        begin_ranges(lights, pass);
        add_by_tiles(lighting, lights, pixels, cost);
    }
    return pixels;
}

void VirtualLightRenderer::Impl::add_by_tiles(const LightingPass& lighting,
                                              const std::vector<VirtualLight>& lights,
                                              std::vector<V3f>& pixels,
                                              VirtualLightStats& cost) const {
    const Stopwatch lighting_watch;
    note(add_tiled_lighting(lighting, lights, Acceptance(options.method, *ranges), pixels), cost);
    cost.lighting_seconds = lighting_watch.seconds() - cost.build_seconds;
    const Stopwatch filter_watch;
    if (options.filter && !lighting.cancelled()) filter_cross_bilateral(lighting.view, pixels);
    cost.filter_seconds = filter_watch.seconds();
}

void VirtualLightRenderer::Impl::add_by_grid(const LightingPass& lighting,
                                             const std::vector<VirtualLight>& lights,
                                             std::vector<V3f>& pixels,
                                             VirtualLightStats& cost) const {
    const Stopwatch build_watch;
    const GridHierarchy hierarchy(lights, options.alpha, options.grid_build);
    const double build_seconds = build_watch.seconds();
    const Stopwatch lighting_watch;
    note(add_grid_lighting(lighting, lights, hierarchy, pixels), cost);
    cost.build_seconds = build_seconds;
    cost.lighting_seconds = lighting_watch.seconds();
}

VirtualLightRenderer::VirtualLightRenderer(std::shared_ptr<const Scene> scene,
                                           const RenderSettings& settings,
                                           const VirtualLightOptions& options,
                                           std::unique_ptr<LightSampler> sampler) {
    if (scene == nullptr) throw Error("renderer: there is no scene");
    check_virtual_light_options(options);
    check_depth(settings);
    check_for_virtual_lights(data_of(*scene));
    if (scene->camera().orthographic_height > 0.0f) {
        throw Error("virtual lights: the camera is orthographic, and their tiles want perspective");
    }
    if (options.source == VirtualLightSource::kShadowMap) check_shadow_map_sources(data_of(*scene));
    impl_ = std::make_unique<Impl>(std::move(scene), settings, options, std::move(sampler));
}

VirtualLightRenderer::~VirtualLightRenderer() = default;

bool VirtualLightRenderer::render_pass(const std::atomic<bool>* cancel) {
    const Clock::time_point start = Clock::now();
    VirtualLightStats cost;
    std::vector<V3f> pixels;
    std::vector<LightsOfPixel> of_pixels = impl_->of_pixels;  // a cancelled pass leaves no trace
    impl_->arena.execute([&] { pixels = impl_->bounced_light(cancel, cost, of_pixels); });
    const double seconds = seconds_since(start);
    if (!impl_->direct.render_pass(cancel)) return false;
    impl_->bounced.add(pixels);
    impl_->seconds += seconds;
    impl_->rays += std::uint64_t{impl_->settings.width} * impl_->settings.height + cost.shadow_rays;
    impl_->stats += cost;
    impl_->of_pixels = std::move(of_pixels);
    return true;
}

std::vector<float3> VirtualLightRenderer::image() const {
    std::vector<float3> sum = impl_->direct.image();
    const std::vector<float3> bounced = impl_->bounced.mean();
    for (std::size_t i = 0; i < sum.size(); ++i) {
        sum[i] = to_float3(to_v3f(sum[i]) + to_v3f(bounced[i]));
    }
    return sum;
}

RenderStats VirtualLightRenderer::stats() const {
    RenderStats stats = impl_->direct.stats();
    stats.seconds += impl_->seconds;
    stats.rays += impl_->rays;
    return stats;
}

const VirtualLightStats& VirtualLightRenderer::virtual_light_stats() const noexcept {
    return impl_->stats;
}

const std::vector<LightsOfPixel>& VirtualLightRenderer::lights_of_pixels() const noexcept {
    return impl_->of_pixels;
}

RendererMemory VirtualLightRenderer::memory_size() const noexcept {
    return impl_->direct.memory_size();
}

VirtualLightMemory VirtualLightRenderer::virtual_light_memory() const {
    return {impl_->arena.execute([&] { return impl_->bytes_of_lights(); }),
            impl_->of_pixels.size() * kBytesPerPixel,
            size_of(impl_->of_pixels) + size_of(impl_->bounced.sums())};
}

}  // namespace lightcull
