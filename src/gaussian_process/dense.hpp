// Regression by the covariance matrix of all observations: any covariance, up to some thousands of them.
#pragma once
#include "core/numeric/random.hpp"
#include "gaussian_process/covariance.hpp"
#include "gaussian_process/linear_mean.hpp"
#include "gaussian_process/observations.hpp"

namespace sysid::gaussian_process {

/// What is added to the diagonal of a covariance that is not positive definite in double precision, relative to the diagonal's
/// mean: nothing, then `first`, then `growth` times more until `most`. What was needed is reported, never hidden.
struct Jitter {
  double first = 1e-12;
  double growth = 10;
  double most = 1e-6;
};

/// Cholesky's factor of the covariance of the function at the rows of inputs, with as little jitter as it needs: a product with
/// normal numbers is a function drawn from the prior, each value of which depends on the rows before alone. parameters: without
/// noise.
struct PriorFactor {
  Eigen::MatrixXd lower;
  double jitter = 0;
  bool fine = false;
};
PriorFactor prior_factor(Covariance const& covariance, Eigen::MatrixXd const& inputs, Numbers parameters,
                         Jitter const& jitter = {});

/// The same of the observations: parameters with the noise's sd behind the others.
PriorFactor observed_factor(Covariance const& covariance, Eigen::MatrixXd const& inputs, Numbers parameters,
                            Jitter const& jitter = {});

/// parameters [P + 1]: the covariance's hyper-parameters, then the noise's sd >= 0. With K the covariance of g + noise, P its
/// inverse with the mean's coefficients integrated out, alpha = P (y - H b):
///
///   d log p/dtheta = 1/2 trace((alpha alpha^T - P) dK/dtheta),   d log p/dy = -alpha        Rasmussen & Williams 2006, eq. 5.9
///
/// The trace is a sum over elements of P, which is formed once. Costs N^3 flops (N^3/3 without gradient) and 8 N^2 bytes.
Marginal dense_marginal(Covariance const& covariance, Observations const& observations, Numbers parameters, bool with_gradient,
                        Jitter const& jitter = {});

/// The function given the observations, at fixed hyper-parameters.
class DensePosterior {
 public:
  /// As above; holds what it needs of the observations.
  DensePosterior(Covariance covariance, Observations observations, std::vector<double> parameters, Jitter const& jitter = {});

  /// The rest may be asked only where it is fine.
  Outcome outcome() const { return mean_.outcome; }
  double jitter() const { return jitter_; }
  double log_likelihood() const { return mean_.log_likelihood; }
  Coefficients coefficients() const { return mean_.coefficients(observations_); }

  /// Rasmussen & Williams 2006, eq. 2.41, 2.42. Variances are never negative: what rounding leaves below zero is zero.
  Prediction predict(Places const& places) const;
  /// Covariance of the function at the places [M x M].
  Eigen::MatrixXd covariance(Places const& places) const;
  /// Functions at the places [M x count]: draw i uses stream key.with_index(i) alone. `jitter` tells what the covariance needed to
  /// be factored; where it cannot be, nothing is drawn: [M x 0].
  struct Samples {
    Eigen::MatrixXd functions;
    double jitter = 0;
  };
  Samples sample(Places const& places, int count, StreamKey key) const;

 private:
  /// L^-1 k(x, places) and what the coefficients add to the function there, R^-T (H_* - k_*^T K^-1 H)^T.
  struct Reach {
    Eigen::MatrixXd known, coefficients;
  };
  Reach reach(Places const& places, Eigen::MatrixXd cross) const;

  Covariance covariance_;
  Observations observations_;
  std::vector<double> parameters_;
  Jitter policy_;
  double jitter_ = 0;
  Eigen::MatrixXd lower_;  // L [N x N]
  LinearMean mean_;
  Eigen::VectorXd alpha_;     // K^-1 (y - H beta) [N]
  Eigen::MatrixXd whitened_;  // L^-1 H [N x p]
};

}  // namespace sysid::gaussian_process
