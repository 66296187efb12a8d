// The Kalman filter as what it is to a regression: the product of L^-1 with columns, K = L L^T, in time proportional to their
// length; backwards through it for derivatives, and for what the whole record says at each instant.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "gaussian_process/state_space_model.hpp"

namespace sysid::gaussian_process {

/// Instants in order; some carry an observation, at others one wants to know.
struct Instants {
  std::vector<double> steps;     // from the instant before, >= 0; the first 0
  std::vector<char> observed;    // whether the instant has an observation
  Eigen::MatrixXd observations;  // [q x instants], columns of what was not observed are not read
};

/// A forward pass: Särkkä & Solin 2019, alg. 10.18, with several right-hand sides in place of one.
struct Filtered {
  bool fine = true;            // no innovation had a variance <= 0
  double log_determinant = 0;  // of the covariance of the observations
  Eigen::MatrixXd whitened;    // L^-1 observations [q x instants]
  // What the way back needs, after each instant's update: means [d q], covariances [d d], and the innovations' variances.
  std::vector<double> means, covariances, variances;
};
Filtered filter(StateSpaceModel& model, Instants const& instants, double noise_variance);

/// Derivatives of a function of the whitened columns and of minus half the log determinant.
struct FilterGradient {
  std::vector<double> parameters;  // in their logarithms
  double noise_variance = 0;
  Eigen::MatrixXd observations;  // [q x instants]
};
/// weights: the function's derivatives in the whitened columns [q x instants]. The reverse of each step of the filter, from the
/// last to the first: its cost does not grow with the number of parameters.
FilterGradient filter_gradient(StateSpaceModel& model, Instants const& instants, Filtered const& filtered,
                               Eigen::MatrixXd const& weights);

/// f at every instant given all observations: mean of each right-hand side, and variance. By the backward recursion that inverts no
/// covariance of states.                                                                        de Jong 1989, eq. 4 to 9
struct Smoothed {
  Eigen::MatrixXd means;      // [q x instants]
  Eigen::VectorXd variances;  // [instants]
};
Smoothed smooth(StateSpaceModel& model, Instants const& instants, Filtered const& filtered);

}  // namespace sysid::gaussian_process
