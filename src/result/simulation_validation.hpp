// Discovered structures in simulation: coefficients fitted to the motion, evidence, stability, errors on held-out rows.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace sysid {

/// Of one channel, in `unit`.
struct ValidatedChannel {
  std::string channel, unit;
  double sd = 0;        // of what is measured on the held-out rows
  double residual = 0;  // sd of the refit's residuals
  double noise = 0;     // as the regression took it; 0: not known
  double growth = 0;    // its sd is found to be in proportion to sqrt(signal^2 + growth^2); 0: alike in all samples
  // Root mean square errors on held-out rows; nothing where there are too few rows, or where a run is not finite.
  std::optional<double> one_step, horizon, free_run;
};

struct ValidatedCoefficient {
  std::string target, term, name, unit;
  double regression = 0, regression_sd = 0;  // in `unit`; not numbers where the regression does not list these terms
  double value = 0, sd = 0;
  bool of_target = false;  // it stands in the target: known to be there
  bool inside = false;     // no coefficient, but a parameter inside terms; it has no target
};

/// A structure: one support for each equation.
struct ValidatedStructure {
  std::string terms;                   // "y'', y', y, y^3"; of several equations "x': x, y; y': ..."
  std::vector<std::string> equations;  // with the refit's coefficients
  int of_regression = 0;               // its place there, from 1; 0: it was found by simulation alone
  std::string failure;                 // why it was not validated; empty: it was
  bool given_up = false;               // it was not, because that costs too much
  double log_evidence = 0, log_prior = 0;
  double probability = 0;          // among the structures tried
  double residual_over_noise = 0;  // of the worst channel; 0: noise not known
  int draws = 0, bounded = 0;
  double follows = 0;  // [s] of the free run until a channel is off by 40 % of its sd
  std::vector<ValidatedCoefficient> coefficients;
  std::vector<ValidatedChannel> channels;

  /// The largest error in percent of a channel's sd; nothing where there is none.
  std::optional<double> percent(std::optional<double> ValidatedChannel::*error) const;
};

/// The most probable equation with terms that the dictionary lacks, against the most probable one without.
struct OutsideEquation {
  std::string text;           // "v': v, exp(-r)"
  double log_odds = 0;        // with the prior of terms and coefficients
  double log_likelihood = 0;  // of it, less that of the one without
  int coefficients = 0;       // more than the one without has; negative: fewer
  double samples = 0;         // of the record

  /// Of the log likelihood what is left with its coefficients counted: log likelihood - coefficients/2 log(samples), Schwarz 1978.
  double criterion() const;
};

struct ValidationReport {
  std::vector<ValidatedStructure> structures;  // best first
  int segments = 0;                            // of which the refit starts each afresh
  double shortest = 0, longest = 0;            // of a segment [s]
  bool whole = false;                          // no record could be cut less
  double step = 0;                             // [s] of the record
  double horizon = 0;                          // [s] of predictions k steps ahead
  int horizon_rows = 0, window_rows = 0;
  std::string held_out;        // "bench.test", "the last fifth of bench"; empty: nothing was scored
  bool held_out_seen = false;  // the choice of structures saw these rows
  std::string solver;
  std::optional<OutsideEquation> outside;
};

}  // namespace sysid
