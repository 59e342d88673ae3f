#include <lightcull/virtual_lights/virtual_light_renderer.h>

#include "arena.h"
#include "arrays.h"
#include "interruptible.h"
#include "module.h"

#include <tbb/task_arena.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace lightcull::python {
namespace {

using Clock = std::chrono::steady_clock;

/// A VirtualLightRenderer for Python: one call at a time, without the GIL, and open to Ctrl-C.
class InterruptibleVirtualLights {
  public:
    InterruptibleVirtualLights(std::shared_ptr<const Scene> scene, const std::string& method,
                               const std::string& sampler, const RenderSettings& settings)
        : settings_(settings) {
        const Clock::time_point start = Clock::now();
        const VirtualLightOptions options = parse_virtual_light_method(method);
        tbb::task_arena arena(arena_size(settings.threads));
        arena.execute([&] {
            renderer_ = std::make_unique<VirtualLightRenderer>(
                scene, settings, options, make_scene_sampler(sampler, *scene, settings));
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

    RenderStats stats() {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return renderer_->stats();
    }

    VirtualLightStats virtual_light_stats() {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return renderer_->virtual_light_stats();
    }

    double setup_seconds() const noexcept { return setup_seconds_; }

  private:
    RenderSettings settings_;
    std::unique_ptr<VirtualLightRenderer> renderer_;
    double setup_seconds_ = 0.0;
    std::mutex mutex_;
};

std::unique_ptr<InterruptibleVirtualLights> make_virtual_lights(
    std::shared_ptr<Scene> scene, const std::string& method, const std::string& sampler,
    std::uint32_t width, std::uint32_t height, std::uint32_t max_depth, std::uint64_t seed,
    std::uint32_t threads) {
    RenderSettings settings;
    settings.width = width;
    settings.height = height;
    settings.max_depth = max_depth;
    settings.seed = seed;
    settings.threads = threads;
    const py::gil_scoped_release release;
    return std::make_unique<InterruptibleVirtualLights>(std::move(scene), method, sampler,
                                                        settings);
}

}  // namespace

void bind_virtual_lights(py::module_& module) {
    py::class_<VirtualLightStats>(module, "VirtualLightStats")
        .def_readonly("lights", &VirtualLightStats::lights)
        .def_readonly("generation_seconds", &VirtualLightStats::generation_seconds)
        .def_readonly("build_seconds", &VirtualLightStats::build_seconds)
        .def_readonly("lighting_seconds", &VirtualLightStats::lighting_seconds)
        .def_readonly("filter_seconds", &VirtualLightStats::filter_seconds)
        .def_readonly("pixels", &VirtualLightStats::pixels)
        .def_readonly("listed", &VirtualLightStats::listed)
        .def_readonly("accepted", &VirtualLightStats::accepted)
        .def_readonly("shadow_rays", &VirtualLightStats::shadow_rays)
        .def_readonly("error_bound", &VirtualLightStats::error_bound)
        .def_readonly("map_points", &VirtualLightStats::map_points);
    py::class_<InterruptibleVirtualLights>(module, "VirtualLightRenderer")
        .def(py::init(&make_virtual_lights), py::arg("scene"), py::arg("method"),
             py::arg("sampler"), py::arg("width"), py::arg("height"), py::arg("max_depth"),
             py::arg("seed"), py::arg("threads"))
        .def("render_pass", &InterruptibleVirtualLights::render_pass)
        .def("image", &InterruptibleVirtualLights::image)
        .def("stats", &InterruptibleVirtualLights::stats)
        .def("virtual_light_stats", &InterruptibleVirtualLights::virtual_light_stats)
        .def("setup_seconds", &InterruptibleVirtualLights::setup_seconds);
    module.def(
        "check_virtual_light_method",
        [](const std::string& method) { parse_virtual_light_method(method); },
        "Throws Error for a description that VirtualLightRenderer does not take.");
}

}  // namespace lightcull::python
