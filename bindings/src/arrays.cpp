#include "arrays.h"

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

[[noreturn]] void throw_type_error(const py::handle& array, const char* name, const ArraySpec& spec,
                                   const char* remark) {
    const std::string dtype =
        py::hasattr(spec.dtype, "names") && !spec.dtype.attr("names").is_none()
            ? "structured"
            : std::string(py::str(spec.dtype));
    const char* const order = spec.any_stride ? "an aligned " : "a C-contiguous ";
    throw py::type_error(std::string(name) + ": wanted " + order + dtype + " array of shape " +
                         shape_text(spec.shape) + ", got " + description_of(array) + remark);
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
    const bool is_record = !dtype.attr("names").is_none();
    const std::uintptr_t alignment =
        is_record ? alignof(float) : static_cast<std::uintptr_t>(info.itemsize);
    const auto is_multiple = [&](py::ssize_t stride) {
        return static_cast<std::uintptr_t>(stride) % alignment == 0;
    };
    return reinterpret_cast<std::uintptr_t>(info.ptr) % alignment == 0 &&
           std::all_of(info.strides.begin(), info.strides.end(), is_multiple);
}

}  // namespace

py::buffer_info read_array(const py::handle& array, const char* name, const ArraySpec& spec) {
    if (!py::hasattr(array, "dtype") || PyObject_CheckBuffer(array.ptr()) == 0 ||
        !py::object(array.attr("dtype")).equal(spec.dtype))
        throw_type_error(array, name, spec, "");
    py::buffer_info info = py::reinterpret_borrow<py::buffer>(array).request();
    if (!matches(info.shape, spec.shape)) throw_type_error(array, name, spec, "");
    if (info.size > 0 && !spec.any_stride && !is_contiguous(info))
        throw_type_error(array, name, spec, " that is not C-contiguous");
    if (info.size > 0 && !is_aligned(info, spec.dtype))
        throw_type_error(array, name, spec, " that is not aligned");
    return info;
}

py::object numpy_dtype(const py::object& description) {
    return py::module_::import("numpy").attr("dtype")(description);
}

py::object new_array(const py::tuple& shape, const py::object& dtype) {
    return py::module_::import("numpy").attr("empty")(shape, dtype);
}

Image image_from_array(const py::object& array, const char* name) {
    const py::buffer_info info =
        read_array(array, name, {numpy_dtype(py::str("float32")), {-1, -1, 3}});
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
