#include "arrays.h"
#include "own_samplers.h"
#include "records.h"

#include <lightcull/error.h>

#include <algorithm>
#include <cstdint>

namespace lightcull::python {
namespace {

/// Points as the arrays that Python's select and prob take.
struct PointArrays {
    py::object positions, normals, diffuse, lobe, sets;

    explicit PointArrays(Span<const ShadingPoint> points) {
        const auto make = [&](const py::object& dtype) {
            return new_array(py::make_tuple(points.size()), dtype);
        };
        const py::object float32 = numpy_dtype(py::str("float32"));
        positions = new_array(py::make_tuple(points.size(), 3), float32);
        normals = new_array(py::make_tuple(points.size(), 3), float32);
        diffuse = make(float32);
        lobe = make(lobe_dtype());
        sets = make(numpy_dtype(py::str("uint32")));
        const Span<float3> p = elements<float3>(positions), n = elements<float3>(normals);
        const Span<float> d = elements<float>(diffuse);
        const Span<GlossyLobe> l = elements<GlossyLobe>(lobe);
        const Span<std::uint32_t> s = elements<std::uint32_t>(sets);
        for (std::size_t i = 0; i < points.size(); ++i) {
            p[i] = points[i].position;
            n[i] = points[i].normal;
            d[i] = points[i].diffuse;
            l[i] = points[i].lobe;
            s[i] = points[i].set;
        }
    }
};

/// The result of a call, or another where it throws: what is left for that is a lack of memory.
template <typename Result, typename Call>
Result or_else(Result otherwise, const Call& call) noexcept {
    try {
        return call();
    } catch (...) {
        return otherwise;
    }
}

template <typename T>
py::object array_of(Span<const T> values, const py::object& dtype) {
    py::object array = new_array(py::make_tuple(values.size()), dtype);
    std::copy(values.begin(), values.end(), elements<T>(array).begin());
    return array;
}

class ObjectSampler final : public LightSampler {
  public:
    explicit ObjectSampler(const py::object& sampler)
        : sampler_(sampler),
          set_count_(py::cast<std::uint32_t>(sampler.attr("set_count"))),
          needs_receipt_(py::cast<bool>(sampler.attr("needs_receipt"))) {}

    ~ObjectSampler() override {
        or_else(0, [&] {
            const py::gil_scoped_acquire acquire;
            sampler_ = py::object();
            return 0;
        });
    }

    void begin_pass(std::uint64_t pass) override {
        const py::gil_scoped_acquire acquire;
        sampler_.attr("begin_pass")(pass);
    }

    std::unique_ptr<const LightSelector> pass(std::uint64_t) const override {
        throw Error("sampler: one of Python's has no passes as objects of their own");
    }

    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const override {
        const py::gil_scoped_acquire acquire;
        const PointArrays arrays(points);
        const py::object numbers = array_of(u, numpy_dtype(py::str("float32")));
        const py::object chosen = sampler_.attr("select")(arrays.positions, arrays.normals, numbers,
                                                          arrays.sets, arrays.diffuse, arrays.lobe);
        const auto count = static_cast<py::ssize_t>(points.size());
        const py::buffer_info info = read_array(chosen, "select", {selection_dtype(), {count}});
        const auto* const first = static_cast<const Selection*>(info.ptr);
        std::copy(first, first + count, selections.begin());
    }

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        return or_else(Selection{}, [&] {
            Selection selection;
            select({&point, 1}, {&u, 1}, {&selection, 1});
            return selection;
        });
    }

    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        return or_else(0.0f, [&] { return asked_prob(point, receipt, light); });
    }

    std::uint32_t set_count() const noexcept override { return set_count_; }
    bool needs_receipt() const noexcept override { return needs_receipt_; }

  private:
    float asked_prob(const ShadingPoint& point, const Receipt& receipt, std::uint32_t light) const {
        const py::gil_scoped_acquire acquire;
        const PointArrays arrays({&point, 1});
        const Selection selection{light, 1.0f, 1.0f, receipt};
        const py::object selections = array_of<Selection>({&selection, 1}, selection_dtype());
        const py::object lights =
            array_of<std::uint32_t>({&light, 1}, numpy_dtype(py::str("uint32")));
        return py::cast<float>(sampler_.attr("prob")(arrays.positions, arrays.normals, selections,
                                                     lights, arrays.diffuse, arrays.lobe));
    }

    py::object sampler_;  ///< raises nothing: GuardedSampler of the package sees to that
    std::uint32_t set_count_;
    bool needs_receipt_;
};

}  // namespace

std::unique_ptr<LightSampler> sampler_of_object(const py::object& sampler) {
    return std::make_unique<ObjectSampler>(sampler);
}

}  // namespace lightcull::python
