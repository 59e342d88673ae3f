#include <lightcull/error.h>
#include <lightcull/instruction_set.h>
#include <lightcull/render/renderer.h>
#include <lightcull/render/shadow_rays.h>
#include <lightcull/sampler_info.h>
#include <lightcull/sets.h>

#include "arena.h"
#include "arrays.h"
#include "counts.h"
#include "devices.h"
#include "module.h"

#include <pybind11/stl.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace lightcull::python {
namespace {

/// Points that share a set of random ranges, as in the renderer.
/// Thinned points stay together in runs of this many, so that they are as coherent as before.
constexpr std::size_t kRun = 64;
constexpr std::size_t kCountedPoints = 2048;

template <typename Action>
double seconds_of(const Action& action) {
    const auto start = std::chrono::steady_clock::now();
    action();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Points and the lights chosen for them last.
struct BenchPoints {
    explicit BenchPoints(std::vector<ShadingPoint> p)
        : points(std::move(p)), u(points.size()), selections(points.size()) {
        draw(0);
    }

    /// Draws the random numbers of a round: the same in every run.
    void draw(std::uint32_t round) {
        std::mt19937 random(round);
        for (float& number : u) number = static_cast<float>(random() >> 8) * 0x1p-24f;
    }

    /// About `count` of the points, spread evenly.
    std::unique_ptr<BenchPoints> thinned(std::size_t count) const {
        const std::size_t runs = std::max<std::size_t>(count / kRun, 1);
        const std::size_t step = std::max<std::size_t>(points.size() / runs, kRun);
        std::vector<ShadingPoint> kept;
        for (std::size_t first = 0; first < points.size(); first += step) {
            const std::size_t end = std::min(first + kRun, points.size());
            kept.insert(kept.end(), points.begin() + static_cast<std::ptrdiff_t>(first),
                        points.begin() + static_cast<std::ptrdiff_t>(end));
        }
        return std::make_unique<BenchPoints>(std::move(kept));
    }

    std::vector<ShadingPoint> points;
    std::vector<float> u;
    std::vector<Selection> selections;
};

/// A sampler over a scene, and the clock: each call that works returns how many seconds of wall
/// time it took on the given number of threads.
class TimedSampler {
  public:
    TimedSampler(std::shared_ptr<const Scene> scene, const std::string& description,
                 const RenderSettings& settings, const std::string& device)
        : scene_(std::move(scene)), settings_(settings), arena_(arena_size(settings.threads)) {
        build_seconds_ = timed([&] {
            sampler_ = on_device(make_scene_sampler(description, *scene_, settings_), device);
        });
        begin_pass(0);
    }

    double begin_pass(std::uint64_t pass) {
        return timed([&] { sampler_->begin_pass(pass); });
    }

    double select_batch(BenchPoints& points) const {
        return timed([&] { sampler_->select(points.points, points.u, points.selections); });
    }

    double select_single(BenchPoints& points) const {
        using Range = tbb::blocked_range<std::size_t>;
        return timed([&] {
            tbb::parallel_for(Range(0, points.points.size(), 1024), [&](const Range& range) {
                for (std::size_t i = range.begin(); i != range.end(); ++i)
                    points.selections[i] = sampler_->select(points.points[i], points.u[i]);
            });
        });
    }

    /// The seconds that shadow rays take, their number, and how many arrive: they go from the
    /// points to the lights chosen for them last.
    std::tuple<double, std::size_t, std::size_t> trace_shadow_rays(
        const BenchPoints& points) const {
        const ShadowRays rays(*scene_, points.points, points.selections);
        std::size_t arrived = 0;
        const double seconds = timed([&] { arrived = rays.trace(); });
        return {seconds, rays.size(), arrived};
    }

    bool wants_reports() const noexcept { return sampler_->wants_reports(); }

    /// Selects for the points by random numbers of `round`, and reports what shadow rays find.
    void learn(BenchPoints& points, std::uint32_t round) const {
        points.draw(round);
        select_batch(points);
        const ShadowRays rays(*scene_, points.points, points.selections);
        std::vector<std::uint8_t> arrived(rays.size());
        timed([&] { rays.trace(arrived); });
        std::vector<LightOutcome> outcomes;
        for (std::size_t i = 0; i < points.points.size(); ++i) {
            const Selection& s = points.selections[i];
            if (!(s.prob > 0.0f)) continue;
            const float visibility = arrived[outcomes.size()] != 0 ? 1.0f : 0.0f;
            outcomes.push_back({points.points[i].position, points.points[i].normal, s.receipt,
                                s.light, visibility});
        }
        sampler_->report(outcomes);
    }

    std::unique_ptr<BenchPoints> path_points(std::uint32_t depth) const {
        std::vector<ShadingPoint> points;
        timed([&] { points = lightcull::path_points(*scene_, settings_, *sampler_, depth); });
        return std::make_unique<BenchPoints>(std::move(points));
    }

    /// Makes points with sets by packets.
    std::unique_ptr<BenchPoints> points(Span<const float3> positions,
                                        Span<const float3> normals) const {
        std::vector<ShadingPoint> points(positions.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            points[i].position = positions[i];
            points[i].normal = normals[i];
            points[i].set = set_of_packet(static_cast<std::uint32_t>(i / kPointsPerPacket),
                                          sampler_->set_count());
        }
        return std::make_unique<BenchPoints>(std::move(points));
    }

    MeanCounts counts(const BenchPoints& points) const {
        return mean_counts(*sampler_, points.points, kCountedPoints);
    }

    double build_seconds() const noexcept { return build_seconds_; }
    std::uint32_t set_count() const noexcept { return sampler_->set_count(); }
    std::size_t cell_count() const noexcept { return sampler_info(*sampler_)->cell_count(); }
    std::size_t memory_size() const noexcept { return sampler_info(*sampler_)->memory_size(); }

  private:
    template <typename Action>
    double timed(const Action& action) const {
        return seconds_of([&] { arena_.execute(action); });
    }

    std::shared_ptr<const Scene> scene_;
    RenderSettings settings_;
    mutable tbb::task_arena arena_;
    std::unique_ptr<LightSampler> sampler_;
    double build_seconds_ = 0.0;
};

std::unique_ptr<TimedSampler> make_timed_sampler(std::shared_ptr<Scene> scene,
                                                 const std::string& description,
                                                 std::uint32_t width, std::uint32_t height,
                                                 std::uint32_t max_depth, std::uint32_t threads,
                                                 const std::string& device) {
    RenderSettings settings;
    settings.width = width;
    settings.height = height;
    settings.max_depth = max_depth;
    settings.threads = threads;
    return std::make_unique<TimedSampler>(std::move(scene), description, settings, device);
}

std::unique_ptr<BenchPoints> points_from(const TimedSampler& sampler, const py::object& positions,
                                         const py::object& normals) {
    const Rows<float3> rows(positions, "positions");
    return sampler.points(rows.span(), Rows<float3>(normals, "normals", rows.size()).span());
}

}  // namespace

void bind_bench(py::module_& module) {
    using Released = py::call_guard<py::gil_scoped_release>;
    module.def("instruction_sets", &instruction_sets,
               "The instruction sets that selection can use on this machine, best first.");
    module.def("instruction_set", &instruction_set, "The one in use.");
    module.def(
        "use_instruction_set", [](const std::string& name) { use_instruction_set(name); },
        py::arg("name"),
        "Makes all samplers use one of instruction_sets(). Only while none is at work.");
    py::class_<BenchPoints>(module, "BenchPoints")
        .def("__len__", [](const BenchPoints& points) { return points.points.size(); })
        .def("thinned", &BenchPoints::thinned);
    py::class_<TimedSampler>(module, "TimedSampler")
        .def(py::init(&make_timed_sampler), py::arg("scene"), py::arg("description"),
             py::arg("width"), py::arg("height"), py::arg("max_depth"), py::arg("threads"),
             py::arg("device") = "cpu", Released())
        .def("begin_pass", &TimedSampler::begin_pass, Released())
        .def("select_batch", &TimedSampler::select_batch, Released())
        .def("select_single", &TimedSampler::select_single, Released())
        .def("trace_shadow_rays", &TimedSampler::trace_shadow_rays, Released())
        .def("wants_reports", &TimedSampler::wants_reports)
        .def("learn", &TimedSampler::learn, Released())
        .def("cell_count", &TimedSampler::cell_count)
        .def("path_points", &TimedSampler::path_points, Released())
        .def("points", &points_from)
        .def("counts", &TimedSampler::counts, Released())
        .def("build_seconds", &TimedSampler::build_seconds)
        .def("set_count", &TimedSampler::set_count)
        .def("memory_size", &TimedSampler::memory_size);
}

}  // namespace lightcull::python
