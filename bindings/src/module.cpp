#include "module.h"

#include <lightcull/error.h>

PYBIND11_MODULE(_core, module) {
    module.doc() = "The compiled part of lightcull. Use the package `lightcull`.";
    pybind11::register_exception<lightcull::Error>(module, "Error", PyExc_RuntimeError);
    lightcull::python::bind_image(module);
    lightcull::python::bind_obj(module);
    lightcull::python::bind_scene(module);
    lightcull::python::bind_sampler(module);
    lightcull::python::bind_renderer(module);
    lightcull::python::bind_virtual_lights(module);
    lightcull::python::bind_bench(module);
    lightcull::python::bind_devices(module);
    module.attr("VERSION") = LIGHTCULL_VERSION;
    module.attr("BUILD") = LIGHTCULL_BUILD;
}
