// By which parameters of a model the derivatives of its residuals are taken through tangents of the program.
#pragma once
#include <vector>

#include "model/model.hpp"
#include "program/simulation_program.hpp"

namespace sysid {

/// Parameters that have a prior and that a program reads, in the model's order; none where derivatives by them are not exact or
/// would mislead. source: of the residuals or of the likelihood.
///
/// They mislead where an equation may jump at a place that states or these parameters move. The derivative of what is computed is
/// that between two jumps, but the response follows the jumps: a force that yields at a limit does not depend on the limit but by
/// when it yields.
std::vector<int> differentiable_parameters(Model const& model, SimulationSource const& source);

}  // namespace sysid
