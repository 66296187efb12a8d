// Constraints that the compiler differentiated: how far trajectories drift from them.
#pragma once
#include "app/session.hpp"
#include "inference/backend.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {

/// Per invariant of the model the largest drift over the trajectories, in words: a note, above a thousandth of the terms' size a
/// warning. Trajectories that failed do not count.
Findings drift_findings(Session const& session, Model const& model, Trajectory::Result const& result, std::string const& record);

}  // namespace sysid
