// What a regression is given and what it gives back; the routes to it share these.
#pragma once
#include <Eigen/Core>

namespace sysid::gaussian_process {

/// y = H beta + g(x) + noise: g a Gaussian process of mean 0, noise white, beta with independent normal priors.
struct Observations {
  Eigen::MatrixXd inputs;                // x [N x D]
  Eigen::VectorXd values;                // y [N]; a mean that is no sum with free factors has been subtracted by the caller
  Eigen::MatrixXd columns;               // H [N x p], p may be 0
  Eigen::VectorXd prior_mean, prior_sd;  // of beta [p]; an infinite sd stands for a flat density of 1, with mean 0
};

enum class Outcome {
  fine,
  not_positive_definite,  // the covariance of the observations, with all the jitter that is allowed
  dependent_columns,      // two flat coefficients say the same: beta is not determined
  not_finite,             // an infinite or undefined number appeared
};

/// The log marginal likelihood, all constants kept, with beta integrated out.
struct Marginal {
  Outcome outcome = Outcome::fine;
  double log_likelihood = 0;        // -infinity unless fine
  Eigen::VectorXd gradient;         // in the logarithms of the covariance's hyper-parameters and of the noise's sd [P + 1]
  Eigen::VectorXd values_gradient;  // in y [N], for whoever computes the mean
  double jitter = 0;                // what was added to the diagonal, relative to its mean
};

/// Where to predict: inputs [M x D], the mean's columns there [M x p].
struct Places {
  Eigen::MatrixXd inputs, columns;
};

/// Of the function H beta + g; an observation there has the noise's variance more.
struct Prediction {
  Eigen::VectorXd mean, variance;  // [M]
};

/// The mean's coefficients given the observations.
struct Coefficients {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

}  // namespace sysid::gaussian_process
