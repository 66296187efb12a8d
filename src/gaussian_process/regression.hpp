// Regression by whichever route is the faster: the matrix of all observations, or filtering where the covariance allows it and they
// are many. The results are the same to 1e-8.
#pragma once
#include "gaussian_process/covariance.hpp"
#include "gaussian_process/observations.hpp"

namespace sysid::gaussian_process {

/// Whether filtering it is, with work proportional to the number of observations; else it grows with its cube.
bool filters(Covariance const& covariance, Observations const& observations);

/// The same before anything is evaluated, for so many observations.
bool filters(Covariance const& covariance, Eigen::Index observations);

/// Of one evaluation by the matrix of so many observations, with its gradient; roughly, on one processor.
struct DenseWork {
  double bytes = 0, seconds = 0;
};
DenseWork dense_work(double observations);
/// The same of predictions by that matrix, at so many places one after the other.
DenseWork posterior_work(double observations, double places);

/// As `dense_marginal`.
Marginal marginal(Covariance const& covariance, Observations const& observations, Numbers parameters, bool with_gradient);

struct Conditional {
  Outcome outcome = Outcome::fine;
  Prediction prediction;      // at the places
  Coefficients coefficients;  // of the mean
};
/// The function at the places and the mean's coefficients given the observations, at fixed hyper-parameters.
Conditional conditional(Covariance const& covariance, Observations const& observations, Numbers parameters, Places const& places);

}  // namespace sysid::gaussian_process
