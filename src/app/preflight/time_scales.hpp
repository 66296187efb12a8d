// A time in years beside rates per second, or in milliseconds and read as seconds: what is said of it as of stiffness or of a
// parameter without influence leads astray.
#pragma once
#include <optional>
#include <vector>

#include "experiment/experiments.hpp"

namespace sysid {

/// `time_scales_apart`, a warning, where even the slowest motion of the equations is over within 1e-5 of a record, and between two
/// of its rows, at all of 64 prior draws, or has a rate above 2 pi over the shortest step between two rows at 95 % of them and no
/// motion grows. The unit of the time or those of the rates are wrong. The motion is that of the equations linearised at the start.
/// Nothing where they have no such rates (a singular Jacobian), or the prior cannot be drawn from.
std::optional<Finding> time_scales_apart(CheckedFile const& file, Model const& model, ParameterSpace const& space,
                                         std::vector<ExperimentData> const& data);

}  // namespace sysid
