#pragma once

#include <lightcull/render/scene_contents.h>

#include <pybind11/pybind11.h>

namespace lightcull::python {

/// What a scene holds, as dictionaries of arrays by the names of the fields; numbers of floats are
/// tuples, what there is none of is None.
pybind11::dict contents_as_dict(const SceneContents& contents);

}  // namespace lightcull::python
