// The solver of a fit whose task states none: chosen by how far finer ones move the modes, and reported.
#pragma once
#include "app/session/preparation.hpp"
#include "app/session/session.hpp"
#include "diagnostics/tolerance.hpp"
#include "inference/backend/backend.hpp"

namespace sysid {

/// Follows the modes that a search has found, on `stated` or a finer solver, to the first one that leaves them where they are. The
/// solver, its modes, moves and findings go into `preparation`, a line about another solver than `stated` to the notices. False:
/// interrupted.
bool refine_solver(Session& session, Task const& task, MakeTarget const& make, ObjectiveKind objective_kind,
                   SolverSettings const& stated, Preparation& preparation, RunContext& context);

}  // namespace sysid
