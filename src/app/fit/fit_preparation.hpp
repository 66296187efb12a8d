// What a fit does before its first sample: the search, the coordinates of members of hierarchies, the solver.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "app/fit/fit_likelihood.hpp"
#include "app/search/record_search.hpp"
#include "app/session/preparation.hpp"
#include "app/session/task_checkpoint.hpp"
#include "diagnostics/tolerance/tolerance.hpp"
#include "search/global/search.hpp"
#include "search/objective_kind.hpp"

namespace sysid {

class FitPreparation {
 public:
  /// All outlive the preparation. checkpoint: dropped where the search fails.
  FitPreparation(Session& session, Task const& task, FitTask const& what, std::vector<ExperimentData> const& data,
                 FitLikelihood& likelihood, ObjectiveKind objective_kind, TaskCheckpoint& checkpoint);

  /// A target of all data, given up in the middle of a simulation when the user interrupts.
  std::unique_ptr<Target> target(SolverSettings const& solver) const;

  /// Fills `preparation`, whose ledger `context` counts in; the likelihood gets its coordinates. False: interrupted. Throws
  /// UserError where the search finds no mode.
  bool run(RunContext& context, Preparation& preparation);

 private:
  SearchableRecord searchable_record() const;
  bool find_references(RunContext const& context, std::uint64_t seed, Preparation& preparation);
  bool require_proper(SearchResult& found, Preparation& preparation, RunContext& context);
  ParameterSpace const* hierarchies() const;
  bool follow_members(SearchResult& found, RunContext& context, Preparation& preparation);

  Session& session_;
  Task const& task_;
  FitTask const& what_;
  std::vector<ExperimentData> const& data_;
  FitLikelihood& likelihood_;
  ObjectiveKind objective_kind_;
  TaskCheckpoint& checkpoint_;
  Eigen::VectorXd before_search_;  // the best place found before the search, where priors are improper
};

}  // namespace sysid
