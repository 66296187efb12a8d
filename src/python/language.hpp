// What notebooks ask of the language: formulas of models, completions, what a name is, pages of messages.
#pragma once
#include <pybind11/pybind11.h>

#include "embed/open_file.hpp"

namespace sysid::python {

/// Of each model its name, its title, its equations, priors and other statements as MathML, and all of them as LaTeX.
pybind11::list typeset_models(embed::OpenFile const& file);

void bind_language(pybind11::module_& module);

}  // namespace sysid::python
