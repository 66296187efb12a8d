// Draws of a posterior weighted as draws of the posterior without some of its samples: Pareto smoothed importance sampling, as the
// package `loo` of R has it.
#pragma once
#include <span>
#include <vector>

namespace sysid {

/// Effective number of draws over their number, for the mean of values that stand chain after chain, all chains of one length: by
/// autocorrelations, in Geyer's monotone pairs. 1 where chains are shorter than 10 or values are equal; above 1 where draws repel
/// one another.                                                                     `relative_eff` of loo 2.5.1
double relative_efficiency(std::span<double const> values, int chains);

struct LeftOut {
  std::vector<double> log_weights;  // their exponentials sum to 1
  double pareto_k = 0;              // above 0.7: not to be trusted
  double relative_efficiency = 1;   // of the draws, for what was left out
};

/// log_ratios: densities that are wanted over those that the draws have, -infinity where they are not; some are finite.
LeftOut weighted(std::span<double const> log_ratios, double relative_efficiency);

/// log_likelihood: of what is left out, under each draw, chain after chain.         Vehtari, Gelman and Gabry 2017
LeftOut leave_out(std::span<double const> log_likelihood, int chains);

/// log sum_s w_s p_s of log w and log p.
double log_mean(std::span<double const> log_weights, std::span<double const> log_density);

/// How far the sum of log means turns on each draw, to first order, so that errors of samples that share draws are not taken for
/// independent ones.
class DrawInfluence {
 public:
  explicit DrawInfluence(std::size_t draws) : influence_(draws, 0) {}
  /// A log mean, as above, of the log density.
  void add(LeftOut const& weights, std::span<double const> log_density, double log_mean);
  double error() const;

 private:
  std::vector<double> influence_;
};

}  // namespace sysid
