// Chooses the route and calls it.
#include "gaussian_process/regression.hpp"

#include "gaussian_process/dense.hpp"
#include "gaussian_process/state_space.hpp"

namespace sysid::gaussian_process {
namespace {

/// Beyond so many observations a filter is the faster.
constexpr Eigen::Index many = 300;

constexpr double operations_per_second = 2e10;

}  // namespace

bool filters(Covariance const& covariance, Eigen::Index observations) { return observations > many && has_state_space(covariance); }
bool filters(Covariance const& covariance, Observations const& observations) {
  return filters(covariance, observations.values.size());
}

DenseWork dense_work(double observations) {
  constexpr double matrices = 3;
  double const square = observations * observations;
  return {matrices * sizeof(double) * square, square * observations / operations_per_second};  // factor n^3/3, inverse 2 n^3/3
}

DenseWork posterior_work(double observations, double places) {
  double const square = observations * observations;
  return {sizeof(double) * square, square * (observations / 3 + places) / operations_per_second};
}

Marginal marginal(Covariance const& covariance, Observations const& observations, Numbers parameters, bool with_gradient) {
  return filters(covariance, observations) ? state_space_marginal(covariance, observations, parameters, with_gradient)
                                           : dense_marginal(covariance, observations, parameters, with_gradient);
}

Conditional conditional(Covariance const& covariance, Observations const& observations, Numbers parameters, Places const& places) {
  if (filters(covariance, observations)) {
    StateSpacePosterior posterior = state_space_posterior(covariance, observations, parameters, places);
    return {posterior.outcome, std::move(posterior.prediction), std::move(posterior.coefficients)};
  }
  DensePosterior const posterior(covariance, observations, {parameters.begin(), parameters.end()});
  if (posterior.outcome() != Outcome::fine) return {posterior.outcome(), {}, {}};
  return {Outcome::fine, posterior.predict(places), posterior.coefficients()};
}

}  // namespace sysid::gaussian_process
