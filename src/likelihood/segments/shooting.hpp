// Coefficients and start states of segments by maximum likelihood: Levenberg-Marquardt on normal equations in the shape of an
// arrowhead.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "likelihood/segments/segments.hpp"

namespace sysid {

struct ShootingOptions {
  /// Ends when a further step would gain less of log likelihood than this: 1e-6 leaves a thousandth of a standard deviation.
  double gain = 1e-6;
  int most_rounds = 60;
  std::function<bool()> interrupted = {};
};

/// The optimum of
///
///   log L = - sum_c n_c/2 (log(2 pi S_c / n_c) + 1),    S_c = sum of squared residuals of channel c, n_c of them
///
/// which is the normal log likelihood with each channel's noise sd at its own optimum S_c/n_c (at least 1e-9 of the channel's sd).
struct ShootingFit {
  ShootingPoint point;
  std::vector<double> squares;   // S_c, SI
  std::vector<double> noise_sd;  // per channel, what k coefficients and all start states used up taken from n_c
  double log_likelihood = 0;
  /// log L + log_coefficient_weight (coefficient_prior.hpp) - states/2 sum_s log(1 + n_s), n_s samples in segment s: the evidence
  /// by Laplace's method under a prior of coefficients with long tails, the prior of each start worth
  /// one sample (Kass, Wasserman 1995). -infinity where the coefficients are not determined.
  double log_evidence = 0;
  Eigen::MatrixXd covariance;            // of the coefficients, start states integrated out, noise as in noise_sd
  std::vector<Eigen::MatrixXd> follows;  // [segments][states x k]: how the best start moves with the coefficients
  bool finite = false;                   // false: nothing else is set
  bool converged = false;
  bool determined = true;  // every coefficient moves the simulations, and no two alike
  bool interrupted = false;
  int rounds = 0;
};

/// Each round is one batch of 1 + k + states simulations of the record: slopes are differences, each perturbation as large as moves
/// the outputs by 1e-6 of their sd (1e-4 with adaptive solvers). Start states are eliminated segment by segment by QR, damping
/// after Marquardt (1963).
ShootingFit fit_by_shooting(SegmentSimulation const& simulation, ShootingPoint from, ShootingOptions const& options = {});

}  // namespace sysid
