#include "arrays.h"

#include <lightcull/error.h>

#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>

namespace lightcull::python {
namespace {

std::string shape_text(const std::vector<py::ssize_t>& shape) {
    std::string text = "(";
    for (std::size_t i = 0; i < shape.size(); ++i) {
        if (i > 0) text += ", ";
        text += shape[i] < 0 ? std::string(1, "NMK"[std::min<std::size_t>(i, 2)])
                             : std::to_string(shape[i]);
    }
    return text + (shape.size() == 1 ? ",)" : ")");
}

std::string description_of(const py::handle& array) {
    if (!py::hasattr(array, "dtype") || !py::hasattr(array, "shape"))
        return py::str(py::type::of(array).attr("__name__"));
    return std::string(py::str(array.attr("dtype"))) + " " +
           std::string(py::str(array.attr("shape")));
}

bool is_record(const py::object& dtype) {
    return !dtype.attr("names").is_none();
}

[[noreturn]] void throw_type_error(const py::handle& array, const char* name,
                                   const ArraySpec& spec) {
    std::string wanted = py::str(spec.dtype);
    if (is_record(spec.dtype))
        wanted = "records of " +
                 std::string(py::str(py::str(", ").attr("join")(spec.dtype.attr("names"))));
    throw py::type_error(std::string(name) + ": wanted an array of shape " +
                         shape_text(spec.shape) + " for " + wanted + ", got " +
                         description_of(array));
}

bool matches(const std::vector<py::ssize_t>& shape, const std::vector<py::ssize_t>& wanted) {
    return std::equal(shape.begin(), shape.end(), wanted.begin(), wanted.end(),
                      [](py::ssize_t n, py::ssize_t want) { return want < 0 || n == want; });
}

bool is_contiguous(const py::buffer_info& info) {
    py::ssize_t stride = info.itemsize;
    for (std::size_t i = info.shape.size(); i-- > 0;) {
        if (info.shape[i] > 1 && info.strides[i] != stride) return false;
        stride *= info.shape[i];
    }
    return true;
}

/// True if the data are aligned: records are made of numbers of 4 bytes.
bool is_aligned(const py::buffer_info& info, const py::object& dtype) {
    const std::uintptr_t alignment =
        is_record(dtype) ? alignof(float) : static_cast<std::uintptr_t>(info.itemsize);
    const auto is_multiple = [&](py::ssize_t stride) {
        return static_cast<std::uintptr_t>(stride) % alignment == 0;
    };
    return reinterpret_cast<std::uintptr_t>(info.ptr) % alignment == 0 &&
           std::all_of(info.strides.begin(), info.strides.end(), is_multiple);
}

/// Throws Error if a number was not kept by a conversion: to a float that is infinite, or to
/// another whole number.
void check_conversion(const py::handle& from, const py::object& to, const char* name) {
    const py::module_ numpy = py::module_::import("numpy");
    const bool to_floats = std::string(py::str(to.attr("dtype").attr("kind"))) == "f";
    const py::object lost =
        to_floats ? numpy.attr("logical_and")(numpy.attr("isinf")(to), numpy.attr("isfinite")(from))
                  : numpy.attr("not_equal")(to, from);
    if (!py::bool_(lost.attr("any")())) return;
    const py::tuple place(numpy.attr("argwhere")(lost).attr("__getitem__")(0).attr("tolist")());
    std::string index;
    for (const py::handle i : place) index += "[" + std::string(py::str(i)) + "]";
    throw Error(std::string(name) + index + " is " + std::string(py::str(from[place])) +
                ", which " + std::string(py::str(to.attr("dtype"))) + " does not hold");
}

/// A copy of an array of another dtype, or in another order, as it is wanted.
py::object converted(const py::handle& array, const char* name, const ArraySpec& spec) {
    const py::module_ numpy = py::module_::import("numpy");
    const py::object dtype = array.attr("dtype");
    const bool same = dtype.equal(spec.dtype);
    const std::string kind = py::str(dtype.attr("kind"));
    const bool is_real = kind == "f" || kind == "i" || kind == "u";
    if (!same && (is_record(spec.dtype) || !is_real)) throw_type_error(array, name, spec);
    // Numbers that are lost are told of below, and not by a warning.
    const py::object convert =
        numpy.attr("errstate")(py::arg("all") = "ignore")(numpy.attr("array"));
    const py::object copy = convert(array, py::arg("dtype") = spec.dtype, py::arg("order") = "C");
    if (!same) check_conversion(array, copy, name);
    return copy;
}

}  // namespace

py::buffer_info read_array(const py::handle& array, const char* name, const ArraySpec& spec) {
    if (!py::hasattr(array, "dtype") || PyObject_CheckBuffer(array.ptr()) == 0)
        throw_type_error(array, name, spec);
    const auto request = [](const py::handle& from) {
        return py::reinterpret_borrow<py::buffer>(from).request();
    };
    const auto shape = array.attr("shape").cast<std::vector<py::ssize_t>>();
    if (!matches(shape, spec.shape)) throw_type_error(array, name, spec);
    if (py::object(array.attr("dtype")).equal(spec.dtype)) {
        py::buffer_info info = request(array);
        const bool in_order = spec.any_stride || is_contiguous(info);
        if (info.size == 0 || (in_order && is_aligned(info, spec.dtype))) return info;
    }
    return request(converted(array, name, spec));
}

py::object numpy_dtype(const py::object& description) {
    return py::module_::import("numpy").attr("dtype")(description);
}

py::object new_array(const py::tuple& shape, const py::object& dtype) {
    return py::module_::import("numpy").attr("empty")(shape, dtype);
}

Image image_from_array(const py::object& array, const char* name) {
    const ArraySpec spec{numpy_dtype(py::str("float32")), {-1, -1, 3}};
    const bool is_float = py::hasattr(array, "dtype") &&
                          std::string(py::str(array.attr("dtype").attr("kind"))) == "f";
    if (!is_float) throw_type_error(array, name, spec);
    const py::buffer_info info = read_array(array, name, spec);
    const auto* pixels = static_cast<const float3*>(info.ptr);
    return {static_cast<std::uint32_t>(info.shape[1]), static_cast<std::uint32_t>(info.shape[0]),
            std::vector<float3>(pixels, pixels + info.size / 3)};
}

py::object array_from_image(Span<const float3> pixels, std::uint32_t width, std::uint32_t height) {
    py::object array = new_array(py::make_tuple(height, width, 3), numpy_dtype(py::str("float32")));
    std::copy(pixels.begin(), pixels.end(), elements<float3>(array).begin());
    return array;
}

float3 float3_from(const py::object& sequence, const char* name) {
    try {
        const auto numbers = py::tuple(sequence);
        if (numbers.size() == 3)
            return {py::float_(numbers[0]), py::float_(numbers[1]), py::float_(numbers[2])};
    } catch (const py::error_already_set&) {
        // The message below says it better.
    }
    throw py::type_error(std::string(name) + ": wanted three numbers, got " +
                         std::string(py::repr(sequence)));
}

}  // namespace lightcull::python
