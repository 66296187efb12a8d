// `sysid._engine.Density`: what the functions of `sysid.Model` call.
#pragma once
#include <pybind11/pybind11.h>

namespace sysid::python {

void bind_density(pybind11::module_& module);

}  // namespace sysid::python
