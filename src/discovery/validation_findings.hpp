// Findings about the validation by simulation.
#pragma once
#include "result/finding.hpp"
#include "result/simulation_validation.hpp"

namespace sysid {

/// validation: with at least one structure.
Findings validation_findings(ValidationReport const& validation);

/// What the regression left unexplained is a note where simulation explains the motion to its noise.
void temper_by_simulation(ValidationReport const& validation, Findings& of_regression);

}  // namespace sysid
