// The summary of the draws of one quantity, as plain numbers.
#pragma once
#include <limits>
#include <string>
#include <vector>

namespace sysid {

/// draws[c][i]: chain c, iteration i; all chains of one length.
using ChainValues = std::vector<std::vector<double>>;

/// Mean, spread, 5 and 95 % quantiles of the draws, declared unit, and the convergence diagnostics (NaN where there are none).
struct Summary {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  std::string name, unit;
  double mean = none, median = none, sd = none, mad = none, q5 = none, q95 = none;
  double rhat = none, ess_bulk = none, ess_tail = none, mcse_mean = none;
  bool coefficient = false;     // of an unknown function: tables leave it out
  std::string without_sd = {};  // of a derived quantity of an optimum: why it has no sd
};

}  // namespace sysid
