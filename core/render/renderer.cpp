#include <lightcull/render/renderer.h>

#include "base/memory_size.h"
#include "base/random.h"
#include "render/camera.h"
#include "render/film.h"
#include "render/scene_data.h"
#include "render/settings.h"
#include "render/tiles.h"
#include "render/trial_image.h"
#include "render/wavefront.h"

#include <lightcull/error.h>
#include <lightcull/sampler_info.h>

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <utility>

namespace lightcull {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What other keys of PixelNumbers than numbers_key() are hashed from beside the seed and the pass.
constexpr std::uint64_t kForTrials = 2, kForTraining = 3;

/// The bytes that LightSampler::select() needs for a point meanwhile.
constexpr std::size_t kSelectionScratch = 20;

/// The sums of a film, three numbers per pixel.
std::vector<double> numbers_of(const Film& film) {
    std::vector<double> numbers;
    numbers.reserve(3 * film.sums().size());
    for (const Imath::V3d& sum : film.sums()) {
        numbers.insert(numbers.end(), {sum.x, sum.y, sum.z});
    }
    return numbers;
}

int thread_count(std::uint32_t wanted) {
    const int available = tbb::info::default_concurrency();
    return wanted == 0 ? available : std::min(static_cast<int>(wanted), available);
}

}  // namespace

struct Renderer::Impl {
    std::shared_ptr<const Scene> scene;
    RenderSettings settings;
    RenderSettings training;  ///< settings of paths that the sampler learns from
    std::unique_ptr<LightSampler> sampler;
    CameraRays camera;
    tbb::task_arena arena;
    std::vector<Wavefront> wavefronts;  ///< one for each tile of a region
    std::vector<ShadingPoint> points;   ///< points of all wavefronts, one after the other
    std::vector<float> selection_numbers;
    std::vector<Selection> selections;
    std::vector<V3f> pass_pixels;
    Film film;
    std::vector<V3f> pass_emission;  ///< part of pass_pixels; empty unless emission is kept apart
    Film emission;
    std::optional<float> last_ray_share;  ///< Pass::last_ray_share, once it has been found
    RenderStats stats;
    RenderStats cost;      ///< statistics of the pass under way
    std::uint64_t refits;  ///< SceneData::refits when the image was begun

    Impl(std::shared_ptr<const Scene> s, const RenderSettings& r, std::unique_ptr<LightSampler> l)
        : scene(std::move(s)),
          settings(r),
          training(r),
          sampler(std::move(l)),
          camera(scene->camera(), r.width, r.height),
          arena(thread_count(r.threads)),
          pass_pixels(std::size_t{r.width} * r.height, V3f(0.0f)),
          film(pass_pixels.size()),
          pass_emission(r.emission_apart ? pass_pixels.size() : 0),
          emission(pass_emission.size()),
          refits(data_of(*scene).refits) {
        // The rays that a BSDF sends tell nothing.
        if (training.direct_light == DirectLight::kMis) {
            training.direct_light = DirectLight::kLights;
        }
    }

    void render_regions(const std::atomic<bool>* cancel);
    void render_all(const Pass& pass);
    void train(const std::atomic<bool>* cancel);
    void render_tiles(const Pass& pass, const std::vector<Tile>& tiles);
    void select_lights(const std::vector<std::uint8_t>& under_way);

    Pass pass_of(std::uint64_t number, const RenderSettings& how, const std::atomic<bool>* cancel);
    void find_last_ray_share(const std::atomic<bool>* cancel);
    double variance_with(float share, const std::atomic<bool>* cancel);
};

void Renderer::Impl::render_regions(const std::atomic<bool>* cancel) {
    // The ranges of light samplers must differ from seed to seed, too.
    const Clock::time_point start = Clock::now();
    sampler->begin_pass(mix(settings.seed) + stats.passes);
    cost.sampler_seconds += seconds_since(start);
    if (sampler->wants_reports()) train(cancel);
    std::fill(pass_pixels.begin(), pass_pixels.end(), V3f(0.0f));
    std::fill(pass_emission.begin(), pass_emission.end(), V3f(0.0f));
    render_all(pass_of(stats.passes, settings, cancel));
}

/// Lets the sampler learn from paths of some pixels, which are no part of the image. Those that are
/// have numbers that cover their range evenly from pass to pass: what was learned from them would
/// depend on numbers to come, and bias the image.
void Renderer::Impl::train(const std::atomic<bool>* cancel) {
    constexpr std::uint32_t kPoints = 1u << 14;  // so many tell enough
    const RenderStats before = cost;
    Pass pass = pass_of(stats.passes, training, cancel);
    pass.numbers_key = hash(settings.seed, kForTraining, stats.passes);
    pass.reports = true;
    pass.one_in = std::clamp(settings.width * settings.height / kPoints, 1u, 16u);
    render_all(pass);
    for (Wavefront& wavefront : wavefronts) wavefront.take_ray_count();
    cost.selections = before.selections;
    cost.selection_seconds = before.selection_seconds;
}

void Renderer::Impl::render_all(const Pass& pass) {
    for (const Tile& region : tiles_of({0, 0, settings.width, settings.height}, kRegionSize)) {
        if (!pass.cancelled()) render_tiles(pass, tiles_of(region, kTileSize));
    }
}

Pass Renderer::Impl::pass_of(std::uint64_t number, const RenderSettings& how,
                             const std::atomic<bool>* cancel) {
    return {data_of(*scene),
            how,
            PassRays(camera, settings, number),
            *sampler,
            vertex_culling(*sampler),
            number,
            hash(settings.seed, number),
            numbers_key(settings, number),
            cancel,
            pass_pixels.data(),
            pass_emission.empty() ? nullptr : pass_emission.data(),
            false,
            1,
            last_ray_share.value_or(1.0f)};
}

void Renderer::Impl::render_tiles(const Pass& pass, const std::vector<Tile>& tiles) {
    if (wavefronts.size() < tiles.size()) wavefronts.resize(tiles.size());
    tbb::parallel_for(std::size_t{0}, tiles.size(),
                      [&](std::size_t i) { wavefronts[i].start(pass, tiles[i]); });
    std::vector<std::uint8_t> under_way(tiles.size(), 1);
    while (std::any_of(under_way.begin(), under_way.end(), [](auto u) { return u != 0; })) {
        tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
            if (under_way[i] != 0) under_way[i] = wavefronts[i].advance() ? 1 : 0;
        });
        select_lights(under_way);
        tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
            if (under_way[i] != 0) wavefronts[i].shade();
        });
    }
}

/// Selects for the points of all wavefronts in one call: the more points, the less each of them
/// costs.
void Renderer::Impl::select_lights(const std::vector<std::uint8_t>& under_way) {
    points.clear();
    selection_numbers.clear();
    for (std::size_t i = 0; i < under_way.size(); ++i) {
        if (under_way[i] == 0) continue;
        const auto p = wavefronts[i].points();
        const auto u = wavefronts[i].selection_numbers();
        points.insert(points.end(), p.begin(), p.end());
        selection_numbers.insert(selection_numbers.end(), u.begin(), u.end());
    }
    if (points.empty()) return;
    selections.resize(points.size());
    const Clock::time_point start = Clock::now();
    sampler->select(points, selection_numbers, selections);
    const double elapsed = seconds_since(start);
    cost.sampler_seconds += elapsed;
    cost.selection_seconds += elapsed * arena.max_concurrency();
    cost.selections += points.size();

    auto next = selections.begin();
    for (std::size_t i = 0; i < under_way.size(); ++i) {
        if (under_way[i] == 0) continue;
        const Span<Selection> into = wavefronts[i].selections();
        const auto end = next + static_cast<std::ptrdiff_t>(wavefronts[i].points().size());
        std::copy(next, end, into.begin());
        next = end;
    }
}

/// Finds, by trial on some pixels, whether a sample varies more if it goes without most last rays.
void Renderer::Impl::find_last_ray_share(const std::atomic<bool>* cancel) {
    last_ray_share = 1.0f;
    const bool may_leave_out = settings.max_depth > 1 &&
                               settings.direct_light == DirectLight::kMis &&
                               vertex_culling(*sampler) == nullptr;
    if (!may_leave_out) return;
    // Fewer cost hardly less, and vary more once a sampler has learned.
    constexpr float kFew = 0.25f;
    constexpr double kAlike = 1.03;
    sampler->begin_pass(mix(settings.seed));
    const double of_all = variance_with(1.0f, cancel), of_few = variance_with(kFew, cancel);
    last_ray_share = of_few <= kAlike * of_all ? kFew : 1.0f;
    if (cancel != nullptr && cancel->load()) last_ray_share.reset();
}

/// The variance of a sample with a share of last rays.
double Renderer::Impl::variance_with(float share, const std::atomic<bool>* cancel) {
    constexpr std::uint64_t kPasses = 8;
    last_ray_share = share;
    TrialImage image(settings);
    for (std::uint64_t k = 0; k < kPasses; ++k) {
        Pass pass = pass_of(k, settings, cancel);
        pass.numbers_key = hash(settings.seed, kForTrials, k);
        render_tiles(pass, image.tiles());
        image.take(pass_pixels);
    }
    for (Wavefront& wavefront : wavefronts) wavefront.take_ray_count();
    return image.relative_variance();
}

Renderer::Renderer(std::shared_ptr<const Scene> scene, const RenderSettings& settings,
                   std::unique_ptr<LightSampler> sampler) {
    if (scene == nullptr) throw Error("renderer: there is no scene");
    if (sampler == nullptr) throw Error("renderer: there is no sampler");
    check_committed(*scene);
    check_settings(settings);
    if (settings.max_depth > 2 && !data_of(*scene).virtual_lights.empty()) {
        throw Error(
            "renderer: max_depth is " + std::to_string(settings.max_depth) +
            ", and the scene has virtual lights, which are all that bounces: wanted 1 or 2");
    }
    impl_ = std::make_unique<Impl>(std::move(scene), settings, std::move(sampler));
}

Renderer::~Renderer() = default;

LightUpdate Renderer::restart(std::uint64_t seed) {
    const Clock::time_point start = Clock::now();
    check_committed(*impl_->scene);
    const LightUpdate update =
        impl_->arena.execute([&] { return impl_->sampler->update(impl_->scene->lights()); });
    impl_->settings.seed = seed;
    impl_->refits = data_of(*impl_->scene).refits;
    impl_->film = Film(impl_->film.sums().size());
    impl_->emission = Film(impl_->emission.sums().size());
    impl_->stats = {};
    impl_->stats.seconds = impl_->stats.sampler_seconds = seconds_since(start);
    return update;
}

bool Renderer::render_pass(const std::atomic<bool>* cancel) {
    check_committed(*impl_->scene);
    if (impl_->refits != data_of(*impl_->scene).refits) {
        throw Error("renderer: the scene was moved, and restart() must come before rendering");
    }
    const Clock::time_point start = Clock::now();
    RenderStats& cost = impl_->cost = {};
    impl_->arena.execute([&] {
        if (!impl_->last_ray_share) impl_->find_last_ray_share(cancel);
        cost = {};
        impl_->render_regions(cancel);
    });
    for (Wavefront& wavefront : impl_->wavefronts) cost.rays += wavefront.take_ray_count();
    if (cancel != nullptr && cancel->load()) {
        impl_->sampler->drop_reports();
        return false;
    }
    impl_->film.add(impl_->pass_pixels);
    impl_->emission.add(impl_->pass_emission);

    RenderStats& stats = impl_->stats;
    ++stats.passes;
    stats.seconds += seconds_since(start);
    stats.sampler_seconds += cost.sampler_seconds;
    stats.selection_seconds += cost.selection_seconds;
    stats.selections += cost.selections;
    stats.rays += cost.rays;
    return true;
}

std::vector<float3> Renderer::image() const {
    return impl_->film.mean();
}
std::vector<float3> Renderer::emission() const {
    return impl_->emission.mean();
}
std::vector<float3> Renderer::lit() const {
    if (!impl_->settings.emission_apart) return {};
    return impl_->film.mean_without(impl_->emission);
}
void Renderer::restore(const RenderState& state) {
    if (impl_->settings.emission_apart) {
        throw Error("renderer: keeps emission apart, of which a state knows nothing");
    }
    check_state(state, impl_->settings);
    // A sampler that has learned would say something else.
    impl_->arena.execute([&] { impl_->find_last_ray_share(nullptr); });
    if (!state.learned.empty()) impl_->sampler->restore_learned(state.learned);
    impl_->film.restore(state.sums, state.stats.passes);
    impl_->stats = state.stats;
}
RenderState Renderer::state() const {
    return {impl_->stats, numbers_of(impl_->film), impl_->sampler->learned()};
}
void Renderer::begin_part(std::uint64_t first_pass, Span<const std::uint8_t> learned) {
    if (!impl_->last_ray_share) {
        impl_->arena.execute([&] { impl_->find_last_ray_share(nullptr); });
    }
    if (!learned.empty()) impl_->sampler->restore_learned(learned);
    impl_->film = Film(impl_->film.sums().size());
    impl_->emission = Film(impl_->emission.sums().size());
    impl_->stats = {};
    impl_->stats.passes = first_pass;
}
bool Renderer::learning() const noexcept {
    const SamplerInfo* const info = sampler_info(*impl_->sampler);
    return info != nullptr && info->learning();
}
std::vector<double> Renderer::emission_sums() const {
    return numbers_of(impl_->emission);
}
const RenderStats& Renderer::stats() const noexcept {
    return impl_->stats;
}
const LightSampler& Renderer::sampler() const noexcept {
    return *impl_->sampler;
}
RendererMemory Renderer::memory_size() const noexcept {
    constexpr std::size_t kPerPath = Wavefront::bytes_per_path() + sizeof(ShadingPoint) +
                                     sizeof(float) + sizeof(Selection) + kSelectionScratch;
    const RenderSettings& r = impl_->settings;
    const std::size_t paths =
        std::size_t{std::min(r.width, kRegionSize)} * std::min(r.height, kRegionSize);
    const SamplerInfo* const info = sampler_info(*impl_->sampler);
    const std::size_t sampler = info != nullptr ? info->memory_size() : 0;
    const std::size_t limit = info != nullptr ? info->memory_limit() : 0;
    return {sampler, limit - sampler,
            impl_->film.memory_size() + impl_->emission.memory_size() +
                size_of(impl_->pass_pixels) + size_of(impl_->pass_emission),
            paths * kPerPath};
}

}  // namespace lightcull
