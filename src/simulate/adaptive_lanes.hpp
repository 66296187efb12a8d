// Embedded Runge-Kutta methods in lanes: every lane finds its own steps, the block goes on when the slowest has arrived.
#pragma once
#include <memory>

#include "simulate/stepper.hpp"

namespace sysid {

/// Attempts the program's step until every lane has reached the next sample. A lane that needs more attempts than the solver's
/// `steps` fails with FailureClass::step_limit.
std::unique_ptr<Stepper> make_adaptive_lanes(LaneFile const& file);

}  // namespace sysid
