// A fit that can be written as a Stan program: the data from which all blocks of the program are written.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "app/session/session.hpp"
#include "experiment/experiments.hpp"

namespace sysid {

struct StanFit {
  Task const& task;
  FitTask const& what;
  SolverSettings solver;
  std::shared_ptr<CompiledModel const> compiled;
  std::shared_ptr<ParameterSpace const> space;
  std::vector<ExperimentData> data;
  std::vector<PriorInfo> priors;  // as the user wrote them

  Model const& model() const { return compiled->model; }
  int states() const { return static_cast<int>(model().states.size()); }
  /// Whether its states are integrated; those of discrete time go from sample to sample.
  bool steps() const { return model().integrated(); }
  /// Whether these steps are exact ones, one per interval.
  bool exact() const { return steps() && solver.row().exact; }
  int substeps() const { return steps() ? solver.substeps : 1; }
};

/// UserError names what Stan cannot be told of the task, as `stan_program` lists it.
StanFit stan_fit(Session& session, Task const& task, SolverSettings const& solver);

/// "`posterior` cannot be written as a Stan program: ...", at the task.
UserError not_carried(Task const& task, std::string const& reason, std::string help);

}  // namespace sysid
