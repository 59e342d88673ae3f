#include "arrays.h"
#include "devices.h"
#include "module.h"
#include "records.h"

#include <lightcull/error.h>
#include <lightcull/light.h>
#include <lightcull/light_sampler.h>
#include <lightcull/render/renderer.h>
#include <lightcull/sampler_info.h>
#include <lightcull/samplers.h>

#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lightcull::python {
namespace {

using Points = std::vector<ShadingPoint>;

/// An object that lights are selected from: a pass, or a sampler with the pass that it is in.
class SharedSelector {
  public:
    SharedSelector(std::shared_ptr<const LightSelector> selector, std::size_t light_count)
        : selector_(std::move(selector)), light_count_(light_count) {}

    /// Calls action(selector) without the GIL.
    template <typename Action>
    void use(const Action& action) const {
        const py::gil_scoped_release release;
        const std::shared_lock lock(mutex_);
        action(*selector_);
    }

    std::size_t light_count() const noexcept { return light_count_; }
    std::uint32_t set_count() const noexcept { return selector_->set_count(); }
    bool needs_receipt() const noexcept { return selector_->needs_receipt(); }
    bool knows(const Receipt& receipt) const noexcept { return selector_->knows(receipt); }

    bool wants_reports() const {
        bool wants = false;
        use([&](const LightSelector& selector) { wants = selector.wants_reports(); });
        return wants;
    }

  protected:
    mutable std::shared_mutex mutex_;

  private:
    std::shared_ptr<const LightSelector> selector_;
    std::size_t light_count_;
};

/// A sampler that any number of Python threads may use: passes wait for the calls under way.
class SharedSampler : public SharedSelector {
  public:
    SharedSampler(const std::shared_ptr<LightSampler>& sampler, std::size_t light_count)
        : SharedSelector(sampler, light_count), sampler_(sampler) {
        sampler_->begin_pass(0);
    }

    void begin_pass(std::uint64_t pass) {
        const py::gil_scoped_release release;
        const std::unique_lock lock(mutex_);
        sampler_->begin_pass(pass);
    }

    std::unique_ptr<SharedSelector> at_pass(std::uint64_t number) const {
        const py::gil_scoped_release release;
        return std::make_unique<SharedSelector>(sampler_->pass(number), light_count());
    }

    py::bytes learned() const {
        std::vector<std::uint8_t> bytes;
        {
            const py::gil_scoped_release release;
            const std::unique_lock lock(mutex_);
            bytes = sampler_->learned();
        }
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }

    /// Pass 0 begins.
    void restore_learned(const py::bytes& learned) {
        const std::string_view bytes = learned;
        const py::gil_scoped_release release;
        const std::unique_lock lock(mutex_);
        sampler_->restore_learned(
            {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
        sampler_->begin_pass(0);
    }

    /// Takes lights that have changed. Returns true if the tree was built anew, and its growth.
    /// Pass 0 begins.
    std::pair<bool, float> update(const py::object& lights, float max_growth) {
        const py::buffer_info info = read_array(lights, "lights", {light_dtype(), {-1}});
        const Span<const Light> span(static_cast<const Light*>(info.ptr),
                                     static_cast<std::size_t>(info.size));
        const py::gil_scoped_release release;
        const std::unique_lock lock(mutex_);
        const LightUpdate done = sampler_->update(span, max_growth);
        sampler_->begin_pass(0);
        return {done.rebuilt, done.growth};
    }

  private:
    std::shared_ptr<LightSampler> sampler_;
};

/// Throws an error about a row of an argument. The hot calls check nothing, so everything is
/// checked here.
[[noreturn]] void throw_row_error(const char* name, std::size_t row, const std::string& problem) {
    throw Error(std::string(name) + "[" + std::to_string(row) + "]: " + problem);
}

bool is_finite(const float3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool is_unit_or_zero(const float3& v) {
    const float length2 = v.x * v.x + v.y * v.y + v.z * v.z;
    return length2 == 0.0f || std::abs(length2 - 1.0f) < 1e-3f;
}

Points points_from(const py::object& positions, const py::object& normals) {
    const Rows<float3> position_rows(positions, "positions");
    const auto normal_rows = Rows<float3>::optional(normals, "normals", position_rows.size());
    const Span<const float3> p = position_rows.span(), n = normal_rows.span();
    Points points(p.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_finite(p[i])) throw_row_error("positions", i, "not finite");
        points[i].position = p[i];
        if (n.empty()) continue;
        if (!is_unit_or_zero(n[i])) throw_row_error("normals", i, "length is neither 1 nor 0");
        points[i].normal = n[i];
    }
    return points;
}

bool is_unit(const float3& v) {
    return is_unit_or_zero(v) && (v.x != 0.0f || v.y != 0.0f || v.z != 0.0f);
}

void set_lobes(Points& points, const py::object& lobe) {
    if (lobe.is_none()) return;
    const auto count = static_cast<py::ssize_t>(points.size());
    const py::buffer_info info = read_array(lobe, "lobe", {lobe_dtype(), {count}});
    const auto* const lobes = static_cast<const GlossyLobe*>(info.ptr);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const GlossyLobe& given = lobes[i];
        if (given.peak == 0.0f) continue;  // there is none: the other fields may be anything
        if (!is_unit(given.axis)) throw_row_error("lobe", i, "length of the axis is not 1");
        if (!(given.alpha > 0.0f && given.alpha <= 1.0f))
            throw_row_error("lobe", i, "alpha is not in (0, 1]");
        if (!(given.peak > 0.0f && std::isfinite(given.peak)))
            throw_row_error("lobe", i, "the peak is below 0 or not finite");
        points[i].lobe = given;
    }
}

/// What the surfaces at the points do with light, from arguments that may be None.
void set_surfaces(Points& points, const py::object& diffuse, const py::object& lobe) {
    const auto rows =
        Rows<float>::optional(diffuse, "diffuse", static_cast<py::ssize_t>(points.size()));
    const Span<const float> d = rows.span();
    for (std::size_t i = 0; i < d.size(); ++i) {
        if (!(d[i] >= 0.0f && std::isfinite(d[i])))
            throw_row_error("diffuse", i, "below 0 or not finite");
        points[i].diffuse = d[i];
    }
    set_lobes(points, lobe);
}

void set_sets(Points& points, const py::object& sets, std::uint32_t set_count) {
    const auto rows =
        Rows<std::uint32_t>::optional(sets, "sets", static_cast<py::ssize_t>(points.size()));
    const Span<const std::uint32_t> s = rows.span();
    for (std::size_t i = 0; i < s.size(); ++i) {
        if (s[i] >= set_count)
            throw_row_error("sets", i, "not below set_count = " + std::to_string(set_count));
        points[i].set = s[i];
    }
}

/// Selections that came from select(), which may have been changed since; they live as long as
/// the array.
Span<const Selection> selections_from(const py::buffer_info& array, Points& points,
                                      const SharedSelector& sampler) {
    const Span<const Selection> selections(static_cast<const Selection*>(array.ptr), points.size());
    for (std::size_t i = 0; i < selections.size(); ++i) {
        if (!sampler.knows(selections[i].receipt))
            throw_row_error("selections", i, "the key is none of this sampler's");
        if (selections[i].prob > 0.0f && selections[i].light >= sampler.light_count())
            throw_row_error("selections", i, "the light is none of this sampler's");
        const float sum = selections[i].receipt.weight_sum;
        if (!std::isfinite(sum)) throw_row_error("selections", i, "the weight_sum is not finite");
        if (selections[i].receipt.key < sampler.set_count()) {
            points[i].set = selections[i].receipt.key;
        }
    }
    return selections;
}

py::buffer_info selection_array(const py::object& array, std::size_t count) {
    return read_array(array, "selections", {selection_dtype(), {static_cast<py::ssize_t>(count)}});
}

/// The way in which points are selected for: in one call, or in one call each.
enum class Entry { kBatch, kSingle };

template <Entry kEntry>
py::object select(const SharedSelector& sampler, const py::object& positions,
                  const py::object& normals, const py::object& u, const py::object& sets,
                  const py::object& diffuse, const py::object& lobe) {
    Points points = points_from(positions, normals);
    set_surfaces(points, diffuse, lobe);
    set_sets(points, sets, sampler.set_count());
    const auto count = static_cast<py::ssize_t>(points.size());
    const Rows<float> numbers(u, "u", count);
    for (std::size_t i = 0; i < numbers.span().size(); ++i)
        if (!(numbers.span()[i] >= 0.0f && numbers.span()[i] < 1.0f))
            throw_row_error("u", i, "not in [0, 1)");

    py::object selections = new_array(py::make_tuple(count), selection_dtype());
    const Span<Selection> result = elements<Selection>(selections);
    sampler.use([&](const LightSelector& s) {
        if constexpr (kEntry == Entry::kBatch) {
            s.select(points, numbers.span(), result);
        } else {
            for (std::size_t i = 0; i < points.size(); ++i)
                result[i] = s.select(points[i], numbers.span()[i]);
        }
    });
    return selections;
}

/// The lights of selections, or those that an argument names for each, checked.
class LightIds {
  public:
    LightIds(const py::object& ids, Span<const Selection> selections, std::size_t light_count)
        : selections_(selections) {
        if (ids.is_none()) return;
        const auto count = static_cast<py::ssize_t>(selections.size());
        info_ = read_array(ids, "lights", {numpy_dtype(py::str("uint32")), {count}, true});
        for (std::size_t i = 0; i < selections.size(); ++i)
            if (named(i) >= light_count)
                throw_row_error("lights", i,
                                "there are " + std::to_string(light_count) + " lights");
    }

    /// Light i, or none where nothing was selected and no lights were named.
    std::optional<std::uint32_t> operator[](std::size_t i) const {
        if (info_) return named(i);
        if (selections_[i].prob > 0.0f) return selections_[i].light;
        return std::nullopt;
    }

  private:
    std::uint32_t named(std::size_t i) const {
        const auto* const first = static_cast<const std::uint8_t*>(info_->ptr);
        const auto offset = static_cast<py::ssize_t>(i) * info_->strides[0];
        return *reinterpret_cast<const std::uint32_t*>(first + offset);
    }

    Span<const Selection> selections_;
    std::optional<py::buffer_info> info_;
};

py::object prob(const SharedSelector& sampler, const py::object& positions,
                const py::object& normals, const py::object& selections, const py::object& lights,
                const py::object& diffuse, const py::object& lobe) {
    Points points = points_from(positions, normals);
    set_surfaces(points, diffuse, lobe);
    const py::buffer_info array = selection_array(selections, points.size());
    const Span<const Selection> selected = selections_from(array, points, sampler);
    const LightIds ids(lights, selected, sampler.light_count());
    py::object probs = new_array(py::make_tuple(points.size()), numpy_dtype(py::str("float32")));
    const Span<float> result = elements<float>(probs);
    sampler.use([&](const LightSelector& s) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::optional<std::uint32_t> light = ids[i];
            result[i] = light ? s.prob(points[i], selected[i].receipt, *light) : 0.0f;
        }
    });
    return probs;
}

void report(const SharedSelector& sampler, const py::object& positions, const py::object& normals,
            const py::object& selections, const py::object& visibility) {
    Points points = points_from(positions, normals);
    const py::buffer_info array = selection_array(selections, points.size());
    const Span<const Selection> selected = selections_from(array, points, sampler);
    const Rows<float> parts(visibility, "visibility", static_cast<py::ssize_t>(points.size()));
    std::vector<LightOutcome> outcomes;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const float part = parts.span()[i];
        if (!(part >= 0.0f && part <= 1.0f)) throw_row_error("visibility", i, "not in [0, 1]");
        if (!(selected[i].prob > 0.0f)) continue;
        outcomes.push_back(
            {points[i].position, points[i].normal, selected[i].receipt, selected[i].light, part});
    }
    sampler.use([&](const LightSelector& s) { s.report(outcomes); });
}

py::object vertex_prob(const SharedSelector& sampler, const py::object& positions,
                       const py::object& normals, const py::object& selections,
                       const py::object& vertices) {
    Points points = points_from(positions, normals);
    const py::buffer_info array = selection_array(selections, points.size());
    const Span<const Selection> selected = selections_from(array, points, sampler);
    const Rows<float3> rows(vertices, "vertices", static_cast<py::ssize_t>(points.size()));
    for (std::size_t i = 0; i < rows.span().size(); ++i)
        if (!is_finite(rows.span()[i])) throw_row_error("vertices", i, "not finite");
    py::object probs = new_array(py::make_tuple(points.size()), numpy_dtype(py::str("float32")));
    const Span<float> result = elements<float>(probs);
    sampler.use([&](const LightSelector& s) {
        const VertexCulling* const culling = vertex_culling(s);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Selection& choice = selected[i];
            if (choice.prob > 0.0f) {
                result[i] = culling == nullptr ? 1.0f
                                               : culling->vertex_prob(points[i], choice.receipt,
                                                                      choice.light, rows.span()[i]);
            } else {
                result[i] = 0.0f;
            }
        }
    });
    return probs;
}

py::object count(const SharedSelector& sampler, const py::object& positions,
                 const py::object& normals, const py::object& sets, const py::object& diffuse,
                 const py::object& lobe) {
    Points points = points_from(positions, normals);
    set_surfaces(points, diffuse, lobe);
    set_sets(points, sets, sampler.set_count());
    py::object counts = new_array(py::make_tuple(points.size()), counts_dtype());
    const Span<SelectionCounts> result = elements<SelectionCounts>(counts);
    sampler.use([&](const LightSelector& s) {
        for (std::size_t i = 0; i < points.size(); ++i)
            result[i] = sampler_info(s)->count(points[i]);
    });
    return counts;
}

/// An array of so many lights, of which light(i) makes each.
template <typename Make>
py::object lights_of(py::ssize_t count, const Make& light) {
    py::object lights = new_array(py::make_tuple(count), light_dtype());
    const Span<Light> result = elements<Light>(lights);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = light(i);
    return lights;
}

py::object triangle_lights(const py::object& corners, const py::object& radiance, bool two_sided) {
    const py::buffer_info info =
        read_array(corners, "corners", {numpy_dtype(py::str("float32")), {-1, 3, 3}});
    const auto* corner = static_cast<const float3*>(info.ptr);
    const Rows<float> values(radiance, "radiance", info.shape[0]);
    return lights_of(info.shape[0], [&](std::size_t i) {
        return triangle_light(corner[3 * i], corner[3 * i + 1], corner[3 * i + 2], values.span()[i],
                              two_sided);
    });
}

py::object point_lights(const py::object& positions, const py::object& intensity) {
    const Rows<float3> rows(positions, "positions");
    const Rows<float> values(intensity, "intensity", rows.size());
    return lights_of(rows.size(),
                     [&](std::size_t i) { return point_light(rows.span()[i], values.span()[i]); });
}

py::object spot_lights(const py::object& positions, const py::object& directions,
                       const py::object& intensity, const py::object& inner,
                       const py::object& outer) {
    const Rows<float3> places(positions, "positions");
    const Rows<float3> axes(directions, "directions", places.size());
    const Rows<float> values(intensity, "intensity", places.size());
    const Rows<float> inners(inner, "inner", places.size());
    const Rows<float> outers(outer, "outer", places.size());
    return lights_of(places.size(), [&](std::size_t i) {
        return spot_light(places.span()[i], axes.span()[i], values.span()[i], inners.span()[i],
                          outers.span()[i]);
    });
}

py::object directional_lights(const py::object& directions, const py::object& irradiance) {
    const Rows<float3> rows(directions, "directions");
    const Rows<float> values(irradiance, "irradiance", rows.size());
    return lights_of(rows.size(), [&](std::size_t i) {
        return directional_light(rows.span()[i], values.span()[i]);
    });
}

py::object bounded_lights(const py::object& box_min, const py::object& box_max,
                          const py::object& axes, const py::object& cos_theta_o,
                          const py::object& cos_theta_e, const py::object& power, bool two_sided) {
    const Rows<float3> low(box_min, "box_min");
    const Rows<float3> high(box_max, "box_max", low.size());
    const Rows<float3> axis(axes, "axes", low.size());
    const Rows<float> normals(cos_theta_o, "cos_theta_o", low.size());
    const Rows<float> spread(cos_theta_e, "cos_theta_e", low.size());
    const Rows<float> values(power, "power", low.size());
    return lights_of(low.size(), [&](std::size_t i) {
        return bounded_light(low.span()[i], high.span()[i], axis.span()[i], normals.span()[i],
                             spread.span()[i], two_sided, values.span()[i]);
    });
}

std::unique_ptr<SharedSampler> sampler_of_lights(const py::object& lights,
                                                 const std::string& description,
                                                 const py::object& positions,
                                                 const py::object& normals,
                                                 const std::string& device) {
    const py::buffer_info info = read_array(lights, "lights", {light_dtype(), {-1}});
    const Span<const Light> span(static_cast<const Light*>(info.ptr),
                                 static_cast<std::size_t>(info.size));
    const Points calibration = points_from(positions, normals);
    const py::gil_scoped_release release;
    return std::make_unique<SharedSampler>(
        on_device(make_sampler(description, span, {calibration, 0}), device), span.size());
}

std::unique_ptr<SharedSampler> sampler_of_scene(const Scene& scene, const std::string& description,
                                                const std::string& device) {
    const py::gil_scoped_release release;
    return std::make_unique<SharedSampler>(
        on_device(make_scene_sampler(description, scene, {}), device), scene.lights().size());
}

}  // namespace

void bind_sampler(py::module_& module) {
    module.attr("LIGHT") = light_dtype();
    module.attr("LOBE") = lobe_dtype();
    module.attr("SELECTION") = selection_dtype();
    module.attr("COUNTS") = counts_dtype();
    module.def("triangle_lights", &triangle_lights, py::arg("corners"), py::arg("radiance"),
               py::arg("two_sided") = false);
    module.def("point_lights", &point_lights, py::arg("positions"), py::arg("intensity"));
    module.def("spot_lights", &spot_lights, py::arg("positions"), py::arg("directions"),
               py::arg("intensity"), py::arg("inner"), py::arg("outer"));
    module.def("directional_lights", &directional_lights, py::arg("directions"),
               py::arg("irradiance"));
    module.def("bounded_lights", &bounded_lights, py::arg("box_min"), py::arg("box_max"),
               py::arg("axes"), py::arg("cos_theta_o"), py::arg("cos_theta_e"), py::arg("power"),
               py::arg("two_sided") = false);
    module.def("sampler_of_lights", &sampler_of_lights);
    module.def("sampler_of_scene", &sampler_of_scene);
    module.def("check_sampler", [](const std::string& description) { parse_sampler(description); });
    py::class_<SharedSelector>(module, "LightSelector")
        .def("select", &select<Entry::kBatch>)
        .def("select_single", &select<Entry::kSingle>)
        .def("prob", &prob)
        .def("vertex_prob", &vertex_prob)
        .def("count", &count)
        .def("light_count", &SharedSelector::light_count)
        .def("set_count", &SharedSelector::set_count)
        .def("needs_receipt", &SharedSelector::needs_receipt)
        .def("wants_reports", &SharedSelector::wants_reports)
        .def("report", &report);
    py::class_<SharedSampler, SharedSelector>(module, "LightSampler")
        .def("begin_pass", &SharedSampler::begin_pass)
        .def("at_pass", &SharedSampler::at_pass)
        .def("learned", &SharedSampler::learned)
        .def("restore_learned", &SharedSampler::restore_learned)
        .def("update", &SharedSampler::update);
}

}  // namespace lightcull::python
