// Two samples of one posterior: how far their summaries differ, in Monte Carlo standard errors.
#pragma once
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "result/finding.hpp"
#include "result/summary.hpp"

namespace sysid {

/// One number of a posterior by two back ends.
struct ComparedNumber {
  std::string quantity, unit, what;  // "k", "N/m", "mean", "sd", "q5", "median", "q95"
  double first = 0, second = 0;
  double error = 0;  // of their difference
  /// 0 where both are the same number; infinite where the difference cannot be judged: it is of what is not finite, or has no
  /// error.
  double z() const {
    if (first == second) return 0;
    double const z = (first - second) / error;
    return std::isfinite(first) && std::isfinite(second) && error > 0 && !std::isnan(z) ? z
                                                                                        : std::numeric_limits<double>::infinity();
  }
};

/// draws: of each chain, one quantity. Mean, sd, median, 5 and 95 % quantiles with errors by effective sample sizes: of the mean by
/// that of the draws; of the sd by that of the squared deviations; of a quantile by that of being below it, as half the distance of
/// the quantiles one error to either side of its probability (Vehtari et al. 2021).
std::vector<ComparedNumber> compare_draws(std::string const& name, std::string const& unit, ChainValues const& first,
                                          ChainValues const& second);

/// Mean and sd of a posterior against an optimum with its sd; error: 0.2 sds of the posterior, as a limit of what matters.
std::vector<ComparedNumber> compare_optimum(std::string const& name, std::string const& unit, ChainValues const& draws,
                                            double optimum, double sd);

/// Numbers that differ by more than chance explains, all taken together (Bonferroni), or cannot be compared. first, second: names
/// of the back ends.
Findings agreement_findings(std::vector<ComparedNumber> const& numbers, std::string const& first, std::string const& second,
                            bool with_optimum);

}  // namespace sysid
