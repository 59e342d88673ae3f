#pragma once

#include <lightcull/light_sampler.h>
#include <lightcull/render/renderer.h>

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

namespace lightcull::python {

/// A sampler that is a Python object with the methods begin_pass, select and prob, which take and
/// give arrays as `OwnSampler` of the package has them. They are called with the GIL, from any
/// thread. Called with the GIL.
std::unique_ptr<LightSampler> sampler_of_object(const pybind11::object& sampler);

/// A sampler of a shared object that defines the functions of lightcull.h which make a sampler,
/// draw a pass and select from it.
struct SamplerLibrary {
    std::string path;
    std::string description;  ///< what lightcull_sampler_create() is given
};
std::unique_ptr<LightSampler> sampler_of_library(const SamplerLibrary& library, const Scene& scene,
                                                 const RenderSettings& settings);

}  // namespace lightcull::python
