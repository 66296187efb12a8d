// One candidate of a selection with all that simulates it.
#pragma once
#include <memory>
#include <vector>

#include "app/session/session.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/model_target.hpp"
#include "likelihood/selection/distance.hpp"
#include "likelihood/selection/model_selection_target.hpp"

namespace sysid {

struct Candidate {
  CandidateModel const* what;
  FitTask fit;  // with exact steps where it states no solver and they suit it
  std::shared_ptr<CompiledModel const> compiled;
  std::vector<ExperimentData> data;
  std::shared_ptr<ParameterSpace const> space, simulated;  // of all parameters; of those that a simulation without noise reads
  DistanceMeasure measure;
};

/// All of a set, compiled and with their data; `what` and `set` must outlive them.
std::vector<Candidate> prepare_candidates(Session& session, SelectTask const& what, CandidateSet const& set);

/// Their distances from the data, simulated as stated or with the next finer solver. UserError E6517 where a channel has none.
ModelSelectionTarget selection_target(Session const& session, SelectTask const& what, std::vector<Candidate> const& candidates,
                                      bool finer);

/// The candidate as a fit would see it.
std::unique_ptr<ModelTarget> likelihood_target(Session& session, Candidate const& candidate, SolverSettings const& solver,
                                               ExecutionOptions const& execution);
/// Of other experiments than its own, such as their first rows.
std::unique_ptr<ModelTarget> likelihood_target(Session& session, Candidate const& candidate, std::vector<Experiment> experiments,
                                               SolverSettings const& solver, ExecutionOptions const& execution);

/// UserError E6520 where candidates would score different samples: a likelihood of fewer of them is no weaker model's.
void require_same_samples(std::vector<Candidate> const& candidates, Span place);

/// What a log density of a candidate's record, in its declared units, gains in those of the first candidate: the logarithm of the
/// ratio of units, for every sample.
double log_unit(Candidate const& candidate, Candidate const& first);

}  // namespace sysid
