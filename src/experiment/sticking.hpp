// Dry friction as `sign(v)`: where the motion sticks, no solver succeeds, so messages that recommend another solver would not help.
#pragma once
#include <string>
#include <vector>

#include "experiment/experiments.hpp"
#include "model/model.hpp"

namespace sysid {

/// What to do about an equation that switches with the sign of a state: the smooth form to write, with a scale from the record.
/// Empty for a model without one.
std::string sticking_advice(Model const& model, std::vector<ExperimentData> const& data);

}  // namespace sysid
