// The Gaussian approximation at an optimum: a few Newton steps onto it, then the curvature by central differences in lanes.
#pragma once
#include <Eigen/Core>

#include "search/objective.hpp"
#include "search/run_context.hpp"

namespace sysid {

/// Prior widths: no direction of a mode is taken for longer.
constexpr double longest_width = 10;

constexpr int most_laplace_steps = 30;
constexpr int most_measured_in_full = 24;  // parameters

/// Climbs the last step from `theta` and returns the mode with
///
///   log mass = log density + P/2 log 2 pi - 1/2 log det H,   H = -second derivatives of the log density          MacKay 2003, ch.
///   27
///
/// over the sampler's coordinates, or for an objective that is a density of the declared parameters over those. `guess` is a
/// curvature to choose difference widths by (Gauss-Newton). Above 24 parameters second differences are taken along its axes alone,
/// as P^2 simulations cost more than they tell: what is left out is how the axes turn, not how long they are. Directions along
/// which the curvature leaves more than ten prior widths get those, and are listed in `flat`; where rounding hides how long one is,
/// only if the likelihood has a ridge there (search/ridge.hpp). Declared sds: first order, through the derivative of the declared
/// values. most_steps: of Newton's method, at most.
Mode laplace_mode(Objective const& objective, Eigen::VectorXd theta, Eigen::MatrixXd const& guess, Ledger& ledger,
                  int most_steps = most_laplace_steps);

/// Distance of two modes in units of their widths: sqrt((a - b)' (A + B)^-1 (a - b)), A and B the covariances.
double distance(Mode const& a, Mode const& b);

Eigen::VectorXd theta_of(Mode const& mode);
Eigen::MatrixXd covariance_of(Mode const& mode);
/// As wide as a power b of the likelihood leaves it in a prior of these widths:
///
///   (b S^-1 + (1 - b) diag(width^2)^-1)^-1,   S the mode's covariance
Eigen::MatrixXd covariance_at_power(Mode const& mode, double power, Eigen::VectorXd const& widths);

}  // namespace sysid
