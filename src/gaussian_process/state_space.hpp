// Regression in one input by filtering: exact, in time and memory proportional to the number of observations.
#pragma once
#include "gaussian_process/linear_mean.hpp"
#include "gaussian_process/observations.hpp"
#include "gaussian_process/state_space_model.hpp"

namespace sysid::gaussian_process {

/// What `dense_marginal` gives, for a covariance that has a state-space form; observations in any order. There is no jitter:
/// without noise and with equal or nearly equal inputs it is not positive definite.
Marginal state_space_marginal(Covariance const& covariance, Observations const& observations, Numbers parameters,
                              bool with_gradient);

struct StateSpacePosterior {
  Outcome outcome = Outcome::fine;
  double log_likelihood = 0;
  Prediction prediction;
  Coefficients coefficients;
};
/// The function at the places, in any order, given the observations.
StateSpacePosterior state_space_posterior(Covariance const& covariance, Observations const& observations, Numbers parameters,
                                          Places const& places);

}  // namespace sysid::gaussian_process
