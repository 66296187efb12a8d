// Findings about the validation by simulation.
#pragma once
#include "result/finding.hpp"
#include "result/simulation_validation.hpp"

namespace sysid {

/// judged: with at least one structure.
Findings judged_findings(JudgedReport const& judged);

/// What the regression left unexplained is a note where simulation explains the motion to its noise.
void temper_by_simulation(JudgedReport const& judged, Findings& of_regression);

}  // namespace sysid
