#include "arrays.h"
#include "module.h"

#include <lightcull/image/image.h>
#include <lightcull/image/whole_file.h>

#include <pybind11/stl.h>

#include <algorithm>

namespace lightcull::python {
namespace {

using Metadata = std::map<std::string, std::string>;

py::object read(const std::string& path, bool linear_data) {
    Image image;
    {
        const py::gil_scoped_release release;
        image = read_image(path, linear_data);
    }
    return array_from_image(image.pixels, image.width, image.height);
}

template <typename T>
py::object array_of(const std::vector<T>& samples, const StoredImage& image, const char* dtype) {
    py::tuple shape = py::make_tuple(image.height, image.width);
    if (image.channels == 3) shape = py::make_tuple(image.height, image.width, 3);
    py::object array = new_array(shape, numpy_dtype(py::str(dtype)));
    std::copy(samples.begin(), samples.end(), elements<T>(array).begin());
    return array;
}

py::object read_stored(const std::string& path) {
    StoredImage image;
    {
        const py::gil_scoped_release release;
        image = read_stored_image(path);
    }
    if (!image.samples8.empty()) return array_of(image.samples8, image, "uint8");
    if (!image.samples16.empty()) return array_of(image.samples16, image, "uint16");
    return array_from_image(image.pixels, image.width, image.height);
}

py::object read_layer_array(const std::string& path, const std::string& name) {
    const Image image = read_layer(path, name);
    return array_from_image(image.pixels, image.width, image.height);
}

void write_exr_array(const std::string& path, const py::object& array, bool half,
                     const Metadata& metadata) {
    const Image image = image_from_array(array, "image");
    const py::gil_scoped_release release;
    write_exr(path, image, half ? PixelType::kHalf : PixelType::kFloat, metadata);
}

void write_png_array(const std::string& path, const py::object& array, const Metadata& metadata) {
    const Image image = image_from_array(array, "image");
    const py::gil_scoped_release release;
    write_png(path, image, metadata);
}

py::object view_of_array(const py::object& array, const std::string& view, float exposure_stops) {
    Image image = image_from_array(array, "image");
    {
        const py::gil_scoped_release release;
        image = apply_view(image, view, exposure_stops);
    }
    return array_from_image(image.pixels, image.width, image.height);
}

void write_file(const std::string& path, const py::bytes& bytes) {
    const std::string_view data = bytes;
    const py::gil_scoped_release release;
    write_whole_file(path, {reinterpret_cast<const unsigned char*>(data.data()), data.size()});
}

}  // namespace

void bind_image(py::module_& module) {
    module.def("read_image", &read, py::arg("path"), py::arg("linear_data") = false);
    module.def("read_stored_image", &read_stored, py::arg("path"));
    module.def("read_layer", &read_layer_array, py::arg("path"), py::arg("name"));
    module.def("write_exr", &write_exr_array, py::arg("path"), py::arg("image"),
               py::arg("half") = false, py::arg("metadata") = Metadata());
    module.def("write_png", &write_png_array, py::arg("path"), py::arg("image"),
               py::arg("metadata") = Metadata());
    module.def("write_whole_file", &write_file, py::arg("path"), py::arg("data"));
    module.def("view_names", &view_names);
    module.def("apply_view", &view_of_array, py::arg("image"), py::arg("view"),
               py::arg("exposure_stops") = 0.0f);
}

}  // namespace lightcull::python
