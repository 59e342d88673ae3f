#include <lightcull/virtual_lights/scene_virtual_lights.h>
#include <lightcull/virtual_lights/virtual_light_renderer.h>

#include "interruptible.h"
#include "module.h"

#include <pybind11/numpy.h>

#include <memory>
#include <string>
#include <vector>

namespace lightcull::python {
namespace {

class InterruptibleVirtualLights : public Interruptible<VirtualLightRenderer> {
  public:
    InterruptibleVirtualLights(const std::shared_ptr<const Scene>& scene, const std::string& method,
                               const std::string& sampler, const RenderSettings& settings)
        : Interruptible(settings, [&] {
              const VirtualLightOptions options = parse_virtual_light_method(method);
              return std::make_unique<VirtualLightRenderer>(
                  scene, settings, options, make_scene_sampler(sampler, *scene, settings));
          }) {}

    RendererMemory memory_size() {
        return locked([](const VirtualLightRenderer& renderer) { return renderer.memory_size(); });
    }

    VirtualLightMemory virtual_light_memory() {
        return locked(
            [](const VirtualLightRenderer& renderer) { return renderer.virtual_light_memory(); });
    }

    VirtualLightStats virtual_light_stats() {
        return locked([](const VirtualLightRenderer& renderer) {
            return VirtualLightStats(renderer.virtual_light_stats());
        });
    }

    /// The numbers of lights listed and accepted, as uint32 (H, W, 2).
    py::array_t<std::uint32_t> lights_of_pixels() {
        const std::vector<LightsOfPixel> counts = locked([](const VirtualLightRenderer& renderer) {
            return std::vector<LightsOfPixel>(renderer.lights_of_pixels());
        });
        const std::vector<py::ssize_t> shape{settings().height, settings().width, 2};
        py::array_t<std::uint32_t> array(shape);
        std::uint32_t* next = array.mutable_data();
        for (const LightsOfPixel& of_pixel : counts) {
            *next++ = of_pixel.listed;
            *next++ = of_pixel.accepted;
        }
        return array;
    }
};

std::unique_ptr<InterruptibleVirtualLights> make_virtual_lights(
    const std::shared_ptr<Scene>& scene, const std::string& method, const std::string& sampler,
    std::uint32_t width, std::uint32_t height, std::uint32_t max_depth, std::uint64_t seed,
    std::uint32_t threads, bool hide_emitters) {
    RenderSettings settings = make_render_settings(width, height, max_depth, seed, threads);
    settings.hide_emitters = hide_emitters;
    const py::gil_scoped_release release;
    return std::make_unique<InterruptibleVirtualLights>(scene, method, sampler, settings);
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
    py::class_<VirtualLightMemory>(module, "VirtualLightMemory")
        .def_readonly("lights", &VirtualLightMemory::lights)
        .def_readonly("image", &VirtualLightMemory::image)
        .def_readonly("kept", &VirtualLightMemory::kept);
    py::class_<InterruptibleVirtualLights>(module, "VirtualLightRenderer")
        .def(py::init(&make_virtual_lights), py::arg("scene"), py::arg("method"),
             py::arg("sampler"), py::arg("width"), py::arg("height"), py::arg("max_depth"),
             py::arg("seed"), py::arg("threads"), py::arg("hide_emitters"))
        .def("render_pass", &InterruptibleVirtualLights::render_pass)
        .def("image", &InterruptibleVirtualLights::image)
        .def("stats", &InterruptibleVirtualLights::stats)
        .def("lights_of_pixels", &InterruptibleVirtualLights::lights_of_pixels)
        .def("virtual_light_stats", &InterruptibleVirtualLights::virtual_light_stats)
        .def("memory_size", &InterruptibleVirtualLights::memory_size)
        .def("virtual_light_memory", &InterruptibleVirtualLights::virtual_light_memory)
        .def("setup_seconds", &InterruptibleVirtualLights::setup_seconds);
    module.def(
        "check_virtual_light_method",
        [](const std::string& method) { parse_virtual_light_method(method); },
        "Throws Error for a description that VirtualLightRenderer does not take.");
    module.def("add_virtual_lights", &add_virtual_lights, py::arg("scene"), py::arg("light_paths"),
               py::arg("bounces"), py::arg("seed"), py::call_guard<py::gil_scoped_release>());
}

}  // namespace lightcull::python
