// A fit made ready to be tracked from: its model with the parameters as states, their posterior, a beginning.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "app/session/session.hpp"
#include "tracking/tracker.hpp"

namespace sysid {

struct DriftOption {
  double relative = 0.01;  // sd of the change of a parameter, as a part of it,
  double time = 0;         // [s] over this time; 0: over 1000 rows
  std::string text = {};   // as the user wrote it; empty: nobody did
};

struct TrackOptions {
  std::filesystem::path result;
  std::string data;    // block of the file; empty: the first of the fit
  std::string record;  // another file with its columns, "-" for standard input; empty: that of the block
  int first_row = 1, last_row = 0;
  bool follow = false, at_rest = false;
  std::vector<std::string> parameters;  // empty: all that the equations read
  DriftOption drift;
  FilterRule filter = FilterRule::extended;
  double false_alarms = 1e-5;
  int window = 2048;
};

struct TrackedFit {
  Task const* task = nullptr;
  FitTask const* fit = nullptr;
  std::shared_ptr<CompiledModel const> compiled;  // under the rule of the fit
  ExperimentUse use;                              // whose parameters, and whose columns
  std::vector<TrackedParameter> tracked;
  std::vector<double> values;      // [parameters] posterior means, SI
  std::vector<std::string> fixed;  // sampled, and kept at their posterior means
  TrackedProgram program;
  SolverSettings solver;
  TrackedPrior prior;
  StatePrior states;    // somewhere along the record of the fit
  int fitted_from = 1;  // row at which the fit began to simulate that record
  double step = 1;      // [s] between its rows
  TrackingOptions tracking;
  TrackOptions options;

  Model const& model() const { return compiled->model; }
  DataBlock const& block(Session const& session) const { return session.file.data[static_cast<std::size_t>(use.data)]; }
  /// In the initial values of the model, as an experiment begins.
  StatePrior at_rest(Experiment const& experiment) const;
};

/// Why there is nothing to track, or not so.
UserError no_tracking(std::string message, std::string help);

/// The fit task that a folder holds results of; UserError where there is none of this file.
Task const& task_of_result(Session const& session, std::filesystem::path const& folder);

/// UserError where the fit cannot be tracked, saying why.
TrackedFit tracked_fit(Session& session, TrackOptions const& options);

}  // namespace sysid
