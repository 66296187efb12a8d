// Findings about the validation by simulation.
#pragma once
#include <string>

#include "discovery/residual_memory.hpp"
#include "result/finding.hpp"
#include "result/simulation_validation.hpp"

namespace sysid {

/// What a free run of the leading structure on rows that were held back shows.
enum class FreeRun {
  not_tested,
  follows,  // its error is below 70 % of the sd, or three times the noise, in every channel
  chaotic,  // above, but one dominant period ahead below half the sd
  lost,
};
FreeRun free_run_of(ValidationReport const& validation);

/// validation: with at least one structure.
Findings validation_findings(ValidationReport const& validation);

/// That the residuals of a channel in an experiment are correlated in time.
Finding not_white(std::string const& channel, std::string const& experiment, ResidualMemory const& memory);

/// What the regression left unexplained is a note where simulation explains the motion to its noise.
void temper_by_simulation(ValidationReport const& validation, Findings& of_regression);

}  // namespace sysid
