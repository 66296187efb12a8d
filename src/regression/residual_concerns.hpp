// What the residual of a regression, and the probabilities of its terms, say against it.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <span>

#include "regression/discovery.hpp"

namespace sysid::regression {

/// Of which one is needed and not which: at least one is in, seldom both, neither for sure. joint: as Choice::joint over the terms
/// of the equation.
Concerns interchangeable_terms(Equation const& equation, Eigen::MatrixXd const& joint);

/// Where the form knows what the noise of the channels is in a row. ratio: of the residual to it; share: of the residual in what is
/// explained; own_noise: the equation has been found to be off by itself.
std::optional<Concern> unexplained_residual(double ratio, double share, bool own_noise);

/// Independent windows are what sds and probabilities count on. residual: whitened.
std::optional<Concern> correlated_windows(Eigen::VectorXd const& residual);

/// Of forms that know no covariance: the size of the residual alone, and more of it than a derivative may be off.
void check_against_noise(Dictionary const& dictionary, std::span<Experiment const> experiments, Method const& method,
                         Projection const& projection, Discovery& discovery);

}  // namespace sysid::regression
