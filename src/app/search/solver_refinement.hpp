// The solver of a fit whose task states none: chosen by how far finer ones move the modes, and reported.
#pragma once
#include "app/session/preparation.hpp"
#include "app/session/session.hpp"
#include "diagnostics/tolerance/tolerance.hpp"
#include "inference/backend/backend.hpp"

namespace sysid {

/// Follows the modes that a search has found, on `stated` or a finer solver, to the first one that leaves them where they are. The
/// solver, its modes, moves and findings go into `preparation`, a line about another solver than `stated` to the notices. False:
/// interrupted.
bool refine_solver(Session& session, Task const& task, MakeTarget const& make, ObjectiveKind objective_kind,
                   SolverSettings const& stated, Preparation& preparation, RunContext& context);

/// Findings on modes, of a search or refinement before, give way to those of other modes.
void replace_mode_findings(Findings& findings, Findings const& of_modes);

/// What may help a result that no step of this solver settles.
std::string settling_advice(SolverSettings const& solver);

/// What may help solves that fail as the ledger says, beside the priors and the equations: more `steps` where these are spent, else
/// another method than the one in use. Empty where there is nothing to advise.
std::string solver_advice(SolverSettings const& solver, Ledger const& ledger);

/// Of the prior draws that the search cannot see, where a solver for stiff equations follows them. exact: whether exact steps would
/// suit equations and data.
Findings stiff_prior(SearchSolver const& search, bool exact = false);

}  // namespace sysid
