// The summary of the draws of one quantity, as plain numbers.
#pragma once
#include <string>
#include <vector>

namespace sysid {

/// draws[c][i]: chain c, iteration i; all chains of one length.
using ChainValues = std::vector<std::vector<double>>;

/// Mean, spread, 5 and 95 % quantiles of the draws, declared unit, and the convergence diagnostics (NaN where there are none).
struct Summary {
  std::string name, unit;
  double mean, median, sd, mad, q5, q95, rhat, ess_bulk, ess_tail, mcse_mean;
  bool coefficient = false;  // of an unknown function: tables leave it out
};

}  // namespace sysid
