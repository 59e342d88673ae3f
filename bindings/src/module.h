#pragma once

#include <pybind11/pybind11.h>

namespace lightcull::python {

/// Each function adds one part of the library to the module.
void bind_image(pybind11::module_& module);
void bind_obj(pybind11::module_& module);
void bind_scene(pybind11::module_& module);
void bind_sampler(pybind11::module_& module);
void bind_renderer(pybind11::module_& module);
void bind_virtual_lights(pybind11::module_& module);
void bind_bench(pybind11::module_& module);
void bind_devices(pybind11::module_& module);

}  // namespace lightcull::python
