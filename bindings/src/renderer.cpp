#include <lightcull/error.h>
#include <lightcull/render/renderer.h>
#include <lightcull/sampler_info.h>
#include <lightcull/sets.h>

#include "arrays.h"
#include "counts.h"
#include "interruptible.h"
#include "learned_view.h"
#include "module.h"
#include "own_samplers.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lightcull::python {
namespace {

constexpr std::uint32_t kCountedPoints = 512;

class InterruptibleRenderer : public Interruptible<Renderer> {
  public:
    /// make_sampler: gives the sampler, without the GIL.
    template <typename MakeSampler>
    InterruptibleRenderer(const std::shared_ptr<const Scene>& scene, const RenderSettings& settings,
                          const MakeSampler& make_sampler)
        : Interruptible(
              settings,
              [&] { return std::make_unique<Renderer>(scene, settings, make_sampler()); }),
          scene_(scene) {}

    /// The parts of the image, float32 (H, W, 3). Throws Error unless emission is kept apart.
    py::object emission() {
        return part([](const Renderer& renderer) { return renderer.emission(); });
    }
    py::object lit() {
        return part([](const Renderer& renderer) { return renderer.lit(); });
    }

    /// Whether the sampler's tree was built anew, and how loose it had become before that.
    std::pair<bool, float> restart(std::uint64_t seed) {
        const LightUpdate done = locked([&](Renderer& renderer) { return renderer.restart(seed); });
        return {done.rebuilt, done.growth};
    }

    /// The sums of the passes, as float64 (H, W, 3).
    py::object sums() {
        return array_of_sums(
            locked([](const Renderer& renderer) { return renderer.state().sums; }));
    }

    /// Those of emission() alone. Throws Error unless it is kept apart.
    py::object emission_sums() {
        check_emission_apart();
        return array_of_sums(
            locked([](const Renderer& renderer) { return renderer.emission_sums(); }));
    }

    void begin_part(std::uint64_t first_pass, const py::bytes& learned) {
        const std::string_view bytes = learned;
        const std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
        locked([&](Renderer& renderer) { renderer.begin_part(first_pass, copy); });
    }

    bool learning() {
        return locked([](const Renderer& renderer) { return renderer.learning(); });
    }

    /// What the sampler has learned.
    py::bytes learned() {
        const std::vector<std::uint8_t> bytes =
            locked([](const Renderer& renderer) { return renderer.sampler().learned(); });
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }

    void restore(const RenderStats& stats, const py::object& sums, const py::bytes& learned) {
        const std::string_view bytes = learned;
        const py::buffer_info info = read_array(sums, "sums",
                                                {numpy_dtype(py::str("float64")),
                                                 {static_cast<py::ssize_t>(settings().height),
                                                  static_cast<py::ssize_t>(settings().width), 3}});
        const auto* first = static_cast<const double*>(info.ptr);
        const RenderState state{stats, {first, first + info.size}, {bytes.begin(), bytes.end()}};
        locked([&](Renderer& renderer) { renderer.restore(state); });
    }

    /// The mean cost of a selection at camera points. None where the sampler does not tell.
    std::optional<MeanCounts> mean_counts() {
        return locked([&](const Renderer& renderer) -> std::optional<MeanCounts> {
            if (sampler_info(renderer.sampler()) == nullptr) return std::nullopt;
            std::vector<ShadingPoint> points = camera_points(*scene_, settings(), kCountedPoints);
            const LightSampler& sampler = renderer.sampler();
            for (std::size_t i = 0; i < points.size(); ++i) {
                points[i].set = set_of_packet(static_cast<std::uint32_t>(i), sampler.set_count());
            }
            return python::mean_counts(sampler, points, points.size());
        });
    }

    /// None where nothing was learned.
    std::optional<LearnedView> learned_view() {
        return locked([&](const Renderer& renderer) {
            return python::learned_view(renderer.sampler(), *scene_, settings());
        });
    }

    RendererMemory memory_size() {
        return locked([](const Renderer& renderer) { return renderer.memory_size(); });
    }

  private:
    void check_emission_apart() const {
        if (!settings().emission_apart) throw Error("renderer: emission is not kept apart");
    }

    py::object array_of_sums(const std::vector<double>& sums) {
        py::object array = new_array(py::make_tuple(settings().height, settings().width, 3),
                                     numpy_dtype(py::str("float64")));
        std::copy(sums.begin(), sums.end(), elements<double>(array).begin());
        return array;
    }

    template <typename Part>
    py::object part(const Part& part) {
        check_emission_apart();
        return array_from_image(locked(part), settings().width, settings().height);
    }

    std::shared_ptr<const Scene> scene_;
};

/// The pixels of a view as an array (H, W).
template <typename T>
py::object array_of(const LearnedView& view, const std::vector<T>& pixels, const char* type) {
    py::object array =
        new_array(py::make_tuple(view.height, view.width), numpy_dtype(py::str(type)));
    std::copy(pixels.begin(), pixels.end(), elements<T>(array).begin());
    return array;
}

DirectLight direct_light_of(const std::string& name) {
    if (name == "mis") return DirectLight::kMis;
    if (name == "lights") return DirectLight::kLights;
    if (name == "bsdf") return DirectLight::kBsdf;
    throw Error("direct_light is '" + name + "'; there are mis, lights, bsdf");
}

std::unique_ptr<InterruptibleRenderer> make_renderer(
    const std::shared_ptr<Scene>& scene, const py::object& sampler, std::uint32_t width,
    std::uint32_t height, std::uint32_t max_depth, std::uint64_t seed, std::uint32_t threads,
    std::uint32_t rr_depth, const std::string& direct_light, bool emission_apart, bool even_numbers,
    bool hide_emitters) {
    RenderSettings settings = make_render_settings(width, height, max_depth, seed, threads);
    settings.rr_depth = rr_depth;
    settings.direct_light = direct_light_of(direct_light);
    settings.emission_apart = emission_apart;
    settings.even_numbers = even_numbers;
    settings.hide_emitters = hide_emitters;
    const auto make = [&](const auto& make_sampler) {
        const py::gil_scoped_release release;
        return std::make_unique<InterruptibleRenderer>(scene, settings, make_sampler);
    };
    if (py::isinstance<py::str>(sampler)) {
        const auto description = py::cast<std::string>(sampler);
        return make([&] { return make_scene_sampler(description, *scene, settings); });
    }
    if (py::isinstance<SamplerLibrary>(sampler)) {
        const auto library = py::cast<SamplerLibrary>(sampler);
        return make([&] { return sampler_of_library(library, *scene, settings); });
    }
    std::unique_ptr<LightSampler> own = sampler_of_object(sampler);
    return make([&] { return std::move(own); });
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
        .def_readonly("learned", &RendererMemory::learned)
        .def_readonly("film", &RendererMemory::film)
        .def_readonly("paths", &RendererMemory::paths);
    py::class_<MeanCounts>(module, "MeanCounts")
        .def_readonly("nodes_visited", &MeanCounts::nodes_visited)
        .def_readonly("lights_tested", &MeanCounts::lights_tested)
        .def_readonly("accepted", &MeanCounts::accepted);
    py::class_<LearnedView>(module, "LearnedView")
        .def("cells", [](const LearnedView& v) { return array_of(v, v.cells, "int32"); })
        .def("visibility",
             [](const LearnedView& v) { return array_of(v, v.visibility, "float32"); })
        .def("normals",
             [](const LearnedView& v) { return array_from_image(v.normals, v.width, v.height); })
        .def_readonly("light", &LearnedView::light)
        .def_property_readonly("light_position",
                               [](const LearnedView& v) -> py::object {
                                   if (!v.light_position) return py::none();
                                   const float3& p = *v.light_position;
                                   return py::make_tuple(p.x, p.y, p.z);
                               })
        .def_readonly("cell_count", &LearnedView::cell_count)
        .def_readonly("memory_size", &LearnedView::memory_size);
    py::class_<SamplerLibrary>(module, "SamplerLibrary")
        .def(py::init([](const std::string& path, const std::string& description) {
            return SamplerLibrary{path, description};
        }))
        .def_readonly("path", &SamplerLibrary::path)
        .def_readonly("description", &SamplerLibrary::description);
    py::class_<InterruptibleRenderer>(module, "Renderer")
        .def(py::init(&make_renderer), py::arg("scene"), py::arg("sampler"), py::arg("width"),
             py::arg("height"), py::arg("max_depth"), py::arg("seed"), py::arg("threads"),
             py::arg("rr_depth"), py::arg("direct_light"), py::arg("emission_apart"),
             py::arg("even_numbers"), py::arg("hide_emitters"))
        .def("render_pass", &InterruptibleRenderer::render_pass)
        .def("restart", &InterruptibleRenderer::restart)
        .def("image", &InterruptibleRenderer::image)
        .def("emission", &InterruptibleRenderer::emission)
        .def("lit", &InterruptibleRenderer::lit)
        .def("sums", &InterruptibleRenderer::sums)
        .def("emission_sums", &InterruptibleRenderer::emission_sums)
        .def("learned", &InterruptibleRenderer::learned)
        .def("learning", &InterruptibleRenderer::learning)
        .def("begin_part", &InterruptibleRenderer::begin_part, py::arg("first_pass"),
             py::arg("learned"))
        .def("restore", &InterruptibleRenderer::restore)
        .def("stats", &InterruptibleRenderer::stats)
        .def("mean_counts", &InterruptibleRenderer::mean_counts)
        .def("learned_view", &InterruptibleRenderer::learned_view)
        .def("memory_size", &InterruptibleRenderer::memory_size)
        .def("setup_seconds", &InterruptibleRenderer::setup_seconds);
}

}  // namespace lightcull::python
