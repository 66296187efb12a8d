// The tolerance guard after sampling: does a finer solver change the result? A move is stated only where draws that are weighted
// again, or modes that are found again, confirm it.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "diagnostics/tolerance/tolerance.hpp"
#include "likelihood/target.hpp"
#include "result/draws.hpp"
#include "result/finding.hpp"

namespace sysid {

/// What a finer solver does to the mean of every parameter, from draws that get the weights  w = exp(change of log likelihood):
///
///   move = (sum w theta / sum w - mean theta) / sd,     error^2 = var(w/mean(w) (theta - mean_w) - (theta - mean)) / (n sd^2)
///
/// the second for independent draws (the delta method for a ratio of means); a parameter of fewer effective draws than were
/// weighted has an error larger by the root of that ratio.                                               Robert, Casella 2004,
/// sec. 3.3
struct Reweighting {
  std::vector<double> move, error;  // [P], sds of the draws
  int draws = 0;
  double effective = 0;  // draws, of the weights: (sum w)^2/sum w^2
  double failed = 0;     // share of the draws that the finer solver cannot simulate: they have the weight 0

  /// Whether enough draws bear the weight for the error to be one.
  bool usable() const;
};
/// coarse: of the draws' own solver. count: draws at most, spread over all chains.
Reweighting reweigh(Target const& coarse, Target const& fine, Draws const& draws, int count, Ledger& ledger);

/// How a result stands to a finer solver.
struct SolverCheck {
  enum class Outcome {
    holds,
    mean_moves,   // of posterior draws, weighted again
    mode_moves,   // found again
    width_moves,  // of an optimum that stays: the curvature around it changes, and the sds with it
    modes_merge,  // several of the coarser solver are one
    fails,        // the finer one cannot simulate the result
  };
  struct Moved {
    std::string parameter, unit;
    double move = 0, error = 0;   // [sd]; error: Monte Carlo standard error of a mean, 0 of a mode
    double sd = 0, finer_sd = 0;  // declared unit; of a width
  };
  Outcome outcome = Outcome::holds;
  std::vector<Moved> moved = {};  // those that clearly do, the largest first, at most three
  double failed = 0;              // share of the draws that fail; 1 of an optimum
  int modes = 0, apart = 0;       // that merge: before, after

  double most = 0;  // of all parameters the largest move of a value, named or not [sd]

  bool holds() const { return outcome == Outcome::holds; }
  /// The largest of `moved`, else of all.
  double largest() const { return moved.empty() ? most : moved.front().move; }
};

/// Of draws whose likelihood was estimated: 1000 of them are weighted again by estimates. What scatters in these has errors like
/// any other, so that moves within them are not seen.
SolverCheck check_estimates(Target const& coarse, Target const& fine, Draws const& draws, Ledger& ledger);

/// Of posterior draws. 200 of them are weighted again, and 2000 where these leave it open whether a mean moves by more than
/// `tolerable_move`: open is what lies within three standard errors of it. Where that stays open, or the weights of a few draws
/// outweigh all others, `modes`, those of `coarse`, are found again on `fine`, and their moves in sds of the draws decide.
SolverCheck check_draws(Target const& coarse, Target const& fine, Draws const& draws, std::vector<Mode> const& modes,
                        std::uint64_t seed, Ledger& ledger);

/// Of an optimum, and of several modes: do they keep place and width with the finer solver, of which `fine` is made, and do they
/// stay apart? Rough steps make false modes and false curvature.
SolverCheck check_modes(Target const& fine, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                        Ledger& ledger);

/// In words, for the solver that was used; none where the result holds. chosen: the guard chose it, not the task. A solver that is
/// declared to be a part of the model is no error: a note states what another would give.
Findings tolerance_findings(SolverCheck const& check, SolverSettings const& solver, bool chosen);

/// In words, for a fit by a filter that linearises, where `check` is of the same fit by one that does not. What moves by less than
/// a third of an sd is left alone.
Findings linearisation_findings(SolverCheck const& check);

/// The solver, no coarser than `solver.finer()`, with which a result that moves by `move` sds should stay: an error of order p
/// falls by 2^p for each halving. No finer than the finest that is tried.
SolverSettings fine_enough(SolverSettings const& solver, double move);

}  // namespace sysid
