#pragma once

#include <lightcull/float3.h>
#include <lightcull/image/image.h>
#include <lightcull/span.h>

#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// NumPy arrays go in and out by these. They use the buffer protocol and numpy.empty() in place of
/// py::array, because pybind11 before 2.12 cannot read NumPy 2's array descriptors.

namespace lightcull::python {

namespace py = pybind11;

/// The properties that an array is wanted to have. -1 in the shape stands for any length.
struct ArraySpec {
    py::object dtype;
    std::vector<py::ssize_t> shape;
    bool any_stride = false;  ///< the elements need not follow each other in memory
};

/// Reads an array as specified, C-contiguous unless any stride will do: without copying it where it
/// is that, else a copy. Throws TypeError, with what was wanted and what came, for another shape,
/// and for what is no array of real numbers (of records, where the specified dtype is one); Error
/// for a number that the specified dtype does not hold.
py::buffer_info read_array(const py::handle& array, const char* name, const ArraySpec& spec);

/// The same as numpy.dtype(description).
py::object numpy_dtype(const py::object& description);

/// A new, uninitialised NumPy array.
py::object new_array(const py::tuple& shape, const py::object& dtype);

/// The form of one element of T in an array: its dtype and how many columns (0: none) it takes.
template <typename T>
struct Row;
template <>
struct Row<float> {
    static constexpr const char* kType = "float32";
    static constexpr py::ssize_t kColumns = 0;
};
template <>
struct Row<float2> {
    static constexpr const char* kType = "float32";
    static constexpr py::ssize_t kColumns = 2;
};
template <>
struct Row<float3> {
    static constexpr const char* kType = "float32";
    static constexpr py::ssize_t kColumns = 3;
};
template <>
struct Row<std::uint32_t> {
    static constexpr const char* kType = "uint32";
    static constexpr py::ssize_t kColumns = 0;
};
using Triangle = std::array<std::uint32_t, 3>;
template <>
struct Row<Triangle> {
    static constexpr const char* kType = "uint32";
    static constexpr py::ssize_t kColumns = 3;
};

/// The rows of an array argument, which lives as long as this does.
template <typename T>
class Rows {
  public:
    Rows(const py::object& array, const char* name, py::ssize_t count = -1) {
        ArraySpec spec{numpy_dtype(py::str(Row<T>::kType)), {count}};
        if (Row<T>::kColumns > 0) spec.shape.push_back(Row<T>::kColumns);
        info_ = read_array(array, name, spec);
    }

    /// The rows of an argument that may be None, which has none.
    static Rows optional(const py::object& array, const char* name, py::ssize_t count) {
        return array.is_none() ? Rows() : Rows(array, name, count);
    }

    Span<const T> span() const {
        if (!info_) return {};
        return {static_cast<const T*>(info_->ptr), static_cast<std::size_t>(info_->shape[0])};
    }
    py::ssize_t size() const { return info_ ? info_->shape[0] : 0; }

  private:
    Rows() = default;
    std::optional<py::buffer_info> info_;
};

/// The elements of an array that new_array() made.
template <typename T>
Span<T> elements(const py::object& array) {
    const py::buffer_info info =
        py::buffer(py::reinterpret_borrow<py::object>(array)).request(true);
    return {static_cast<T*>(info.ptr),
            static_cast<std::size_t>(info.size * info.itemsize) / sizeof(T)};
}

/// An image from an array of floats (H, W, 3), row 0 at the top.
Image image_from_array(const py::object& array, const char* name);
py::object array_from_image(Span<const float3> pixels, std::uint32_t width, std::uint32_t height);

/// A float3 from any three numbers. Throws TypeError with the name.
float3 float3_from(const py::object& sequence, const char* name);

}  // namespace lightcull::python
