#pragma once

#include <pybind11/pybind11.h>

namespace lightcull::python {

/// The NumPy dtypes with the layout of lightcull::Light, GlossyLobe, Selection and SelectionCounts.
pybind11::object light_dtype();
pybind11::object lobe_dtype();
pybind11::object selection_dtype();
pybind11::object counts_dtype();

}  // namespace lightcull::python
