// The tolerance guard before sampling: the solver whose error is small against the width of the posterior.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "likelihood/target.hpp"
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
/// draws fail that such steps follow; the first that leaves no more than a fifth, else the first of the best. Where that still
/// loses more than a fifth, the solver for stiff equations tries some of the draws that are lost, unless it is in use.
struct SearchSolver {
  SolverSettings solver;
  double failed_as_given = 0;   // share of the prior draws
  double failed = 0;            // with `solver`
  bool last_helped = false;     // whether with the last solver that was tried notably fewer fail than with all before
  int tried = 0, followed = 0;  // of the draws that fail with `solver`: by the solver for stiff equations

  /// Whether a large part of the prior is lost to explicit steps that an implicit method follows.
  bool stiff() const { return 2 * followed > tried; }
  /// Whether a large part of the prior is lost with the shortest steps, and still shorter ones would follow it: they have followed
  /// more than those before.
  bool too_fast() const { return failed > tolerable && last_helped; }

  static constexpr double tolerable = 0.2, notable = 0.05;
};
/// `stop` ends it early, with nothing that can be used.
SearchSolver search_solver(MakeTarget const& make, SolverSettings const& from, std::uint64_t seed,
                           std::function<bool()> const& stop = {}, Journal* journal = nullptr);

/// The first of `from`, `from.finer()`, ... for which no mode moves or changes its width by more than `tolerable_move` sds at the
/// next one; the modes there, those that came together counted once, those that only a coarser solver could reach left out. Where
/// the widths never come to rest but the values do, the first from which on no value moves by more. Every solver costs twice the
/// one before it: when that has come to many steps, and moves that fall as they do would not be small at the finest either, it is
/// given up.
struct RefinedSolver {
  SolverSettings solver;
  std::vector<Mode> modes;
  std::vector<double> moves;  // of each that was tried: largest move to the next one [sd]
  bool converged = true;      // false: still moving at the finest that is tried (256 substeps, or 1e-12 relative), or lost
  bool lost = false;          // with the next one no mode is finite any more: these are the last that were
  bool given_up = false;      // before the finest, as the modes would not converge there either
  bool widths_alone = false;  // not converged, but the values are: it is the curvature around the modes that does not settle
};
RefinedSolver find_converged_solver(MakeTarget const& make, ObjectiveKind objective_kind, SolverSettings const& from,
                                    std::vector<Mode> modes, RunContext& context);

/// How far the weightiest of `modes` moves on `fine` [sd], infinite where it is not finite there. `stop` ends it early, with a
/// number that means nothing.
double move_to_finer(Target const& fine, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                     Ledger& ledger, std::function<bool()> const& stop = {}, Journal* journal = nullptr);

/// Those of `modes` that have come together, once, with their weights and hits.
std::vector<Mode> merged(std::vector<Mode> const& modes);

/// Of a mode, below which it may move as it likes.
constexpr double weight_of_interest = 0.01;

}  // namespace sysid
