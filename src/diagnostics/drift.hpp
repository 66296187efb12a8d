// Constraints that the compiler differentiated: how far trajectories drift from them.
#pragma once
#include <string>

#include "core/text/source.hpp"
#include "likelihood/trajectory.hpp"
#include "result/finding.hpp"

namespace sysid {

/// Per invariant of the model the largest drift over the trajectories, in words: a note, above a thousandth of the terms' size a
/// warning. Trajectories that failed do not count.
Findings drift_findings(Source const& source, Model const& model, Trajectory::Result const& result, std::string const& record);

}  // namespace sysid
