// The tolerance guard: is the integration error small against the width of the posterior?
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "likelihood/target.hpp"
#include "result/draws.hpp"
#include "search/objective_kind.hpp"
#include "search/run_context.hpp"
#include "solver/solver.hpp"

namespace sysid {

/// A parameter's limits (value plus and minus sd) may move by this many of its sds when the step is halved, or the tolerance made a
/// hundred times smaller.
constexpr double tolerable_move = 0.1;

/// "parameters move by up to 0.3 sd", or that a mode is lost where the move is infinite.
std::string moved(double move);

/// "8 integrator steps per sample", "relative tolerances of 1e-08".
std::string accuracy(SolverSettings const& solver);

using MakeTarget = std::function<std::unique_ptr<Target>(SolverSettings const& solver)>;

/// Steps for the search, which does not see what fails: `from`, or 4, 16 or 64 times its steps where more than a fifth of 256 prior
/// draws fail that such steps follow; the first that leaves no more than a fifth, else the first of the best.
struct SearchSolver {
  SolverSettings solver;
  double failed_as_given = 0;  // share of the prior draws
};
SearchSolver search_solver(MakeTarget const& make, SolverSettings const& from, std::uint64_t seed);

/// The first of `from`, `from.finer()`, ... for which no mode moves or changes its width by more than `tolerable_move` sds at the
/// next one; the modes there, those that came together counted once, those that only a coarser solver could reach left out. Every
/// solver costs twice the one before it: when that has come to many steps, and moves that fall as they do would not be small at the
/// finest either, it is given up.
struct RefinedSolver {
  SolverSettings solver;
  std::vector<Mode> modes;
  std::vector<double> moves;  // of each that was tried: largest move to the next one [sd]
  bool converged = true;      // false: still moving at the finest that is tried (256 substeps, or 1e-12 relative), or lost
  bool lost = false;          // with the next one no mode is finite any more: these are the last that were
  bool given_up = false;      // before the finest, as the modes would not converge there either
};
RefinedSolver find_converged_solver(MakeTarget const& make, ObjectiveKind objective_kind, SolverSettings const& from,
                                    std::vector<Mode> modes, RunContext& context);

/// How far the weightiest of `modes` moves on `fine` [sd], infinite where it is not finite there.
double move_to_finer(Target const& fine, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                     Ledger& ledger);

/// The same question of a solver that the task states: do the modes keep place and width with the finer one, of which `fine` is
/// made, and do they stay apart? Rough steps make false modes and false curvature.
Findings check_modes(Target const& fine, ObjectiveKind objective_kind, std::vector<Mode> const& modes, SolverSettings const& solver,
                     std::uint64_t seed, Ledger& ledger);

/// After sampling: by how many sds each posterior mean moves with the finer solver, from the change of log likelihood over up to
/// 200 draws (to first order the move of a mean is the covariance of the parameter with that change). Names the worst.
struct ToleranceCheck {
  std::string parameter;
  double move = 0;  // [sd]
};
ToleranceCheck check_tolerance(Target const& coarse, Target const& fine, Draws const& draws, Ledger& ledger);

/// Fires above `tolerable_move`. chosen: the guard chose the solver, not the task.
Findings tolerance_findings(ToleranceCheck const& check, SolverSettings const& solver, bool chosen);

}  // namespace sysid
