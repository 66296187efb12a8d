// Quantities derived from parameters alone, for every draw.
#pragma once
#include "likelihood/compiled_model.hpp"
#include "likelihood/parameter_space.hpp"
#include "result/draws.hpp"

namespace sysid {

/// Appends them to every draw in declared units; one that reads what each experiment has for itself is given per experiment, as
/// `fn[bench]`.
void add_derived(CompiledModel const& compiled, ParameterSpace const& space, Draws& draws);

}  // namespace sysid
