#include <lightcull/render/renderer.h>

#include "arena.h"
#include "arrays.h"
#include "counts.h"
#include "interruptible.h"
#include "module.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace lightcull::python {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::uint32_t kCountedPoints = 512;

/// A Renderer for Python: one call at a time, without the GIL, and open to Ctrl-C.
class InterruptibleRenderer {
  public:
    InterruptibleRenderer(std::shared_ptr<const Scene> scene, const std::string& sampler,
                          const RenderSettings& settings)
        : scene_(std::move(scene)), settings_(settings) {
        const Clock::time_point start = Clock::now();
        tbb::task_arena arena(arena_size(settings.threads));
        arena.execute([&] {
            renderer_ = std::make_unique<Renderer>(scene_, settings,
                                                   make_scene_sampler(sampler, *scene_, settings));
        });
        setup_seconds_ = std::chrono::duration<double>(Clock::now() - start).count();
    }

    bool render_pass() {
        return run_interruptibly(mutex_, [&](const std::atomic<bool>* cancel) {
            return renderer_->render_pass(cancel);
        });
    }

    py::object image() {
        std::vector<float3> pixels;
        {
            const py::gil_scoped_release release;
            const std::lock_guard lock(mutex_);
            pixels = renderer_->image();
        }
        return array_from_image(pixels, settings_.width, settings_.height);
    }

    /// float64 (H, W, 3): the sums of the passes.
    py::object sums() {
        RenderState state;
        {
            const py::gil_scoped_release release;
            const std::lock_guard lock(mutex_);
            state = renderer_->state();
        }
        py::object array = new_array(py::make_tuple(settings_.height, settings_.width, 3),
                                     numpy_dtype(py::str("float64")));
        std::copy(state.sums.begin(), state.sums.end(), elements<double>(array).begin());
        return array;
    }

    void restore(const RenderStats& stats, const py::object& sums) {
        const py::buffer_info info = read_array(sums, "sums",
                                                {numpy_dtype(py::str("float64")),
                                                 {static_cast<py::ssize_t>(settings_.height),
                                                  static_cast<py::ssize_t>(settings_.width), 3}});
        const auto* first = static_cast<const double*>(info.ptr);
        const RenderState state{stats, {first, first + info.size}};
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        renderer_->restore(state);
    }

    RenderStats stats() {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return renderer_->stats();
    }

    /// At camera points.
    MeanCounts mean_counts() {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        std::vector<ShadingPoint> points = camera_points(*scene_, settings_, kCountedPoints);
        const LightSampler& sampler = renderer_->sampler();
        for (std::size_t i = 0; i < points.size(); ++i) {
            points[i].set = set_of_packet(static_cast<std::uint32_t>(i), sampler.set_count());
        }
        return python::mean_counts(sampler, points, points.size());
    }

    RendererMemory memory_size() const noexcept { return renderer_->memory_size(); }
    double setup_seconds() const noexcept { return setup_seconds_; }

  private:
    std::shared_ptr<const Scene> scene_;
    RenderSettings settings_;
    std::unique_ptr<Renderer> renderer_;
    double setup_seconds_ = 0.0;
    std::mutex mutex_;
};

std::unique_ptr<InterruptibleRenderer> make_renderer(std::shared_ptr<Scene> scene,
                                                     const std::string& sampler,
                                                     std::uint32_t width, std::uint32_t height,
                                                     std::uint32_t max_depth, std::uint64_t seed,
                                                     std::uint32_t threads) {
    RenderSettings settings;
    settings.width = width;
    settings.height = height;
    settings.max_depth = max_depth;
    settings.seed = seed;
    settings.threads = threads;
    const py::gil_scoped_release release;
    return std::make_unique<InterruptibleRenderer>(std::move(scene), sampler, settings);
}

}  // namespace

void bind_renderer(py::module_& module) {
    py::class_<RenderStats>(module, "RenderStats")
        .def(py::init([](std::uint64_t passes, double seconds, double sampler_seconds,
                         double selection_seconds, std::uint64_t selections, std::uint64_t rays) {
                 return RenderStats{passes,     seconds, sampler_seconds, selection_seconds,
                                    selections, rays};
             }),
             py::arg("passes"), py::arg("seconds"), py::arg("sampler_seconds"),
             py::arg("selection_seconds"), py::arg("selections"), py::arg("rays"))
        .def_readonly("passes", &RenderStats::passes)
        .def_readonly("seconds", &RenderStats::seconds)
        .def_readonly("sampler_seconds", &RenderStats::sampler_seconds)
        .def_readonly("selection_seconds", &RenderStats::selection_seconds)
        .def_readonly("selections", &RenderStats::selections)
        .def_readonly("rays", &RenderStats::rays);
    py::class_<RendererMemory>(module, "RendererMemory")
        .def_readonly("sampler", &RendererMemory::sampler)
        .def_readonly("film", &RendererMemory::film)
        .def_readonly("paths", &RendererMemory::paths);
    py::class_<MeanCounts>(module, "MeanCounts")
        .def_readonly("nodes_visited", &MeanCounts::nodes_visited)
        .def_readonly("lights_tested", &MeanCounts::lights_tested)
        .def_readonly("accepted", &MeanCounts::accepted);
    py::class_<InterruptibleRenderer>(module, "Renderer")
        .def(py::init(&make_renderer), py::arg("scene"), py::arg("sampler"), py::arg("width"),
             py::arg("height"), py::arg("max_depth"), py::arg("seed"), py::arg("threads"))
        .def("render_pass", &InterruptibleRenderer::render_pass)
        .def("image", &InterruptibleRenderer::image)
        .def("sums", &InterruptibleRenderer::sums)
        .def("restore", &InterruptibleRenderer::restore)
        .def("stats", &InterruptibleRenderer::stats)
        .def("mean_counts", &InterruptibleRenderer::mean_counts)
        .def("memory_size", &InterruptibleRenderer::memory_size)
        .def("setup_seconds", &InterruptibleRenderer::setup_seconds);
}

}  // namespace lightcull::python
