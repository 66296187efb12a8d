// The likelihood of the candidates of a selection: modes near their particles, sufficiently fine solvers, evidences.
#pragma once
#include <optional>
#include <vector>

#include "app/selection/candidate.hpp"
#include "inference/backend/selector.hpp"
#include "result/selection.hpp"
#include "search/journal.hpp"

namespace sysid {

/// A model that is less probable than this, by its particles and by its likelihood, is not looked at closely.
constexpr double worth_a_look = 0.01;

struct CandidatePosterior {
  std::vector<Mode> modes;  // by falling share; empty where no climb ended at a finite density
  bool given_up = false;    // the climb, for the others are more probable by 30 nats and more
  SolverSettings solver;    // under which they are
  /// By how many sds a parameter's limits move from the task's solver to the next finer one; nothing where that was not asked.
  std::optional<double> move;
  bool converged = true;  // false: they still move with the finest solver that is tried, or finer ones lose them
};

/// Modes of each candidate's posterior, climbed to from its particles with the task's solver. Of candidates worth a look the solver
/// is made finer until they have converged, as for a fit; where the task states how fine it is, it is asked how far the next finer
/// one moves them. Nothing when interrupted; the journal keeps the searches.
std::optional<std::vector<CandidatePosterior>> candidate_posteriors(Session& session, std::vector<Candidate> const& candidates,
                                                                    SelectionResult const& result, std::uint64_t seed,
                                                                    Journal& journal);

/// Laplace's evidences and model probabilities, densities in the units of the first candidate; nothing for candidates without
/// modes.
std::vector<std::optional<LikelihoodCheck>> evidences(std::vector<Candidate> const& candidates,
                                                      std::vector<CandidatePosterior> const& posteriors,
                                                      SelectionResult const& result);

/// Solvers that shape what is said of a candidate: its particles, which have the task's, or its likelihood. Without posteriors,
/// nothing.
Findings solver_findings(std::vector<Candidate> const& candidates, std::vector<CandidatePosterior> const& posteriors);

}  // namespace sysid
