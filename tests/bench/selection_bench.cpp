#include "benchmarks.h"
#include "registration.h"
#include "subject.h"

#include <lightcull/render/shadow_rays.h>
#include <lightcull/sampler_info.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace lightcull::bench {
namespace {

constexpr const char* kSamplers[] = {"light_bvh", "light_bvh:importance=means", "culled",
                                     "exhaustive"};
constexpr const char* kPointNames[] = {"camera", "bounce1", "bounce2", "uniform"};
constexpr int kThreads[] = {1, 2};

/// A benchmark of one kind of work at some points.
struct Setting {
    std::string sampler;
    std::uint32_t lights;
    PointKind kind;
    int threads;
};

/// The points of a setting; for a sampler that weighs every light only so many as it can manage.
Points points_of(const Setting& setting, const Subject& subject) {
    constexpr std::size_t kMostWork = 100'000'000;
    Points points = make_points(subject, setting.kind);
    if (setting.sampler == "exhaustive") {
        const std::size_t most = std::max<std::size_t>(kMostWork / setting.lights, 64);
        points.points.resize(std::min(points.points.size(), most));
        points.u.resize(points.points.size());
    }
    return points;
}

void report(benchmark::State& state, std::size_t count) {
    using benchmark::Counter;
    state.counters["each"] =
        Counter(static_cast<double>(count), Counter::kIsIterationInvariantRate | Counter::kInvert);
}

/// Measures all of a pass: refit, sorting and selection.
void select_batch(benchmark::State& state, const Setting& setting) {
    Subject& s = subject(setting.sampler, setting.lights);
    const Points points = points_of(setting, s);
    std::vector<Selection> selections(points.points.size());
    std::uint64_t pass = 0;
    on_threads(setting.threads, [&] {
        for ([[maybe_unused]] auto turn : state) {
            s.sampler->begin_pass(++pass);
            s.sampler->select(points.points, points.u, selections);
        }
    });
    report(state, points.points.size());
}

/// Measures the selection alone, one point after the other.
void select_single(benchmark::State& state, const Setting& setting) {
    using Range = tbb::blocked_range<std::size_t>;
    const Subject& s = subject(setting.sampler, setting.lights);
    const Points points = points_of(setting, s);
    std::vector<Selection> selections(points.points.size());
    on_threads(setting.threads, [&] {
        for ([[maybe_unused]] auto turn : state) {
            tbb::parallel_for(Range(0, selections.size(), 1024), [&](const Range& range) {
                for (std::size_t i = range.begin(); i != range.end(); ++i) {
                    selections[i] = s.sampler->select(points.points[i], points.u[i]);
                }
            });
        }
    });
    report(state, points.points.size());
}

/// Measures one ray from each point to the light that was chosen for it.
void shadow_ray(benchmark::State& state, const Setting& setting) {
    const Subject& s = subject(setting.sampler, setting.lights);
    const Points points = points_of(setting, s);
    std::vector<Selection> selections(points.points.size());
    s.sampler->select(points.points, points.u, selections);
    const ShadowRays rays(*s.scene, points.points, selections);
    on_threads(setting.threads, [&] {
        for ([[maybe_unused]] auto turn : state) benchmark::DoNotOptimize(rays.trace());
    });
    report(state, rays.size());
}

/// Counts the work of select() at one point.
void count_work(benchmark::State& state, const Setting& setting) {
    const Subject& s = subject(setting.sampler, setting.lights);
    const Points points = points_of(setting, s);
    const std::size_t step = std::max<std::size_t>(points.points.size() / 1024, 1);
    double nodes = 0.0, lights = 0.0, counted = 0.0;
    for ([[maybe_unused]] auto turn : state) {
        for (std::size_t i = 0; i < points.points.size(); i += step) {
            const SelectionCounts counts = sampler_info(*s.sampler)->count(points.points[i]);
            nodes += counts.nodes_visited;
            lights += counts.lights_tested;
            counted += 1.0;
        }
    }
    state.counters["nodes"] = nodes / counted;
    state.counters["lights_tested"] = lights / counted;
}

using Work = void(benchmark::State&, const Setting&);

void add_work(const std::string& what, Work* work, const Setting& setting) {
    const std::string subject =
        "/" + setting.sampler + "/" + kPointNames[static_cast<int>(setting.kind)];
    add(
        what + subject + setting_name(setting.lights, setting.threads),
        [=](benchmark::State& state) { work(state, setting); }, work == &count_work);
}

}  // namespace

void register_selection(std::uint32_t light_count) {
    for (const std::string sampler : kSamplers) {
        for (const PointKind kind :
             {PointKind::kCamera, PointKind::kBounce1, PointKind::kBounce2, PointKind::kUniform}) {
            for (const int threads : kThreads) {
                const Setting setting{sampler, light_count, kind, threads};
                add_work("select_batch", select_batch, setting);
                add_work("select_single", select_single, setting);
                if (sampler == "culled") add_work("shadow_ray", shadow_ray, setting);
            }
            add_work("count", count_work, {sampler, light_count, kind, 1});
        }
    }
}

}  // namespace lightcull::bench
