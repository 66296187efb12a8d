// Quantities derived from parameters alone, for every draw.
#pragma once
#include <string>

#include "likelihood/compiled_model.hpp"
#include "likelihood/parameter_space.hpp"
#include "result/draws.hpp"

namespace sysid {

/// Of its values, as declared or else in the SI, so that a wrong formula shows by it; empty for a pure number.
std::string unit_of_derived(Derived const& quantity);

/// Appends them to every draw in declared units; one that reads what each experiment has for itself is given per experiment, as
/// `fn[bench]`.
void add_derived(CompiledModel const& compiled, ParameterSpace const& space, Draws& draws);

}  // namespace sysid
