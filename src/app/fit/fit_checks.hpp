// The checks of a finished fit, for every likelihood: one row each. A row that does not apply gives the reason.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/fit/fit_likelihood.hpp"
#include "app/session/preparation.hpp"
#include "diagnostics/tolerance/tolerance_check.hpp"
#include "search/objective_kind.hpp"

namespace sysid {

/// What the checks read.
struct FinishedFit {
  Session& session;
  FitTask const& what;
  FitLikelihood const& likelihood;
  Target const& target;
  std::vector<ExperimentData> const& data;
  Preparation const& preparation;
  FitResult const& result;
  ObjectiveKind objective_kind;
  Ledger const& sampling;  // its failures
  std::uint64_t seed;
  std::optional<SolverCheck> const& accuracy;  // of the draws, where it has been looked at already
  Report& report;                              // holds priors, draws, summary and the findings so far; scores are added
  std::vector<FittedRows> rows;                // per experiment; empty when interrupted
  Ledger extra = {};                           // of solves for checks, which no report shows
};

struct FitCheckRow {
  std::string_view name;
  /// Whether the draws of an interrupted fit suffice.
  bool of_interrupted;
  /// Why it does not apply to this fit, one sentence; empty: it runs.
  std::string (*inapplicable)(FinishedFit const& fit);
  /// Null: it ran before the search, and its findings are among those of the search.
  Findings (*run)(FinishedFit& fit);
  /// Of models with random states alone, and of fits by particles alone: no other fit mentions it.
  bool of_filters = false;
  bool of_particles = false;
  /// Of filters that describe what is random by mean and covariance where this is not exact: no other fit mentions it.
  bool of_moments = false;
};

/// In the order in which their findings are reported.
std::span<FitCheckRow const> fit_check_rows();

/// Runs those that apply: findings and a record of each go into the report.
void run_fit_checks(FinishedFit& fit);

}  // namespace sysid
