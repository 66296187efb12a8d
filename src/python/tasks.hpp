// Tasks of a file, run by the command line's own flow; its results as data.
#pragma once
#include <pybind11/pybind11.h>

namespace sysid::python {

void bind_tasks(pybind11::module_& module);

}  // namespace sysid::python
