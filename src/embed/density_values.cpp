// Prior and likelihood put together, and what lies outside or at the bounds of a prior.
#include "embed/density_values.hpp"

#include <cmath>
#include <limits>

namespace sysid::embed {
namespace {

constexpr double minus_infinity = -std::numeric_limits<double>::infinity();

/// Coordinates that stand for a bound: as far out as `constrain` is made for, and closer to the middle.
constexpr double at_bound = 700, near_bound = 650;
/// By how much a density that has a limit may change between the two: tails that go to zero or infinity change by 50 times a power.
constexpr double limit_change = 1e-3;

/// The lanes whose coordinates are all finite. Values outside a prior's support have none.
std::vector<int> usable_lanes(ConstLanes theta) {
  std::vector<int> lanes;
  for (int w = 0; w < theta.width(); ++w) {
    bool finite = true;
    for (int p = 0; p < theta.rows(); ++p) finite = finite && std::isfinite(theta(p, w));
    if (finite) lanes.push_back(w);
  }
  return lanes;
}

LaneArray columns(ConstLanes all, std::vector<int> const& lanes) {
  LaneArray some(all.rows(), static_cast<int>(lanes.size()));
  for (int p = 0; p < all.rows(); ++p)
    for (std::size_t w = 0; w < lanes.size(); ++w) some(p, static_cast<int>(w)) = all(p, lanes[w]);
  return some;
}

/// Of lanes whose coordinates are finite.
std::vector<double> finite_log_density(Target const& target, ConstLanes theta, Part part, bool jacobian, Ledger& ledger) {
  std::vector<double> prior(static_cast<std::size_t>(theta.width())), likelihood(prior);
  if (part != Part::likelihood) target.log_prior(theta, prior, jacobian);
  if (part != Part::prior) target.log_likelihood(theta, likelihood, ledger);
  for (std::size_t w = 0; w < prior.size(); ++w) {
    prior[w] += likelihood[w];
    if (std::isnan(prior[w])) prior[w] = minus_infinity;
  }
  return prior;
}

std::vector<double> usable_log_density(Target const& target, ConstLanes theta, Part part, bool jacobian, Ledger& ledger) {
  std::vector<int> const usable = usable_lanes(theta);
  if (static_cast<int>(usable.size()) == theta.width()) return finite_log_density(target, theta, part, jacobian, ledger);
  std::vector<double> all(static_cast<std::size_t>(theta.width()), minus_infinity);
  if (usable.empty()) return all;
  std::vector<double> const some = finite_log_density(target, columns(theta, usable), part, jacobian, ledger);
  for (std::size_t i = 0; i < usable.size(); ++i) all[static_cast<std::size_t>(usable[i])] = some[i];
  return all;
}

/// Coordinates at which finite values have infinite ones, the bounds of supports, as finite coordinates of this size.
LaneArray with_bounds(ConstLanes values, ConstLanes theta, double size) {
  LaneArray out(theta.rows(), theta.width());
  for (int p = 0; p < theta.rows(); ++p)
    for (int w = 0; w < theta.width(); ++w)
      out(p, w) = std::isinf(theta(p, w)) && std::isfinite(values(p, w)) ? std::copysign(size, theta(p, w)) : theta(p, w);
  return out;
}

std::vector<int> lanes_at_bounds(ConstLanes values, ConstLanes theta) {
  std::vector<int> lanes;
  for (int w = 0; w < theta.width(); ++w) {
    bool at = false;
    for (int p = 0; p < theta.rows(); ++p) at = at || (std::isinf(theta(p, w)) && std::isfinite(values(p, w)));
    if (at) lanes.push_back(w);
  }
  return lanes;
}

}  // namespace

std::vector<double> log_density(Target const& target, ConstLanes theta, Part part, Ledger& ledger) {
  return usable_log_density(target, theta, part, true, ledger);
}

std::vector<double> declared_log_density(Target const& target, ConstLanes values, Part part, Ledger& ledger) {
  LaneArray theta(values.rows(), values.width());
  target.unconstrain(values, theta);
  std::vector<int> const bounds = lanes_at_bounds(values, theta);
  if (bounds.empty()) return usable_log_density(target, theta, part, false, ledger);
  LaneArray const at = with_bounds(values, theta, at_bound);
  std::vector<double> density = usable_log_density(target, at, part, false, ledger);
  Ledger none;
  std::vector<double> const prior = usable_log_density(target, columns(at, bounds), Part::prior, false, none);
  std::vector<double> const within =
      usable_log_density(target, columns(with_bounds(values, theta, near_bound), bounds), Part::prior, false, none);
  for (std::size_t i = 0; i < bounds.size(); ++i)
    if (!(std::abs(prior[i] - within[i]) < limit_change)) density[static_cast<std::size_t>(bounds[i])] = minus_infinity;
  return density;
}

ValueAndGradient log_density_with_gradient(Target const& target, ConstLanes theta, Ledger& ledger) {
  std::vector<double> value(static_cast<std::size_t>(theta.width())), prior(value);
  LaneArray gradient(theta.rows(), theta.width()), of_prior(theta.rows(), theta.width());
  target.log_likelihood_gradient(theta, value, gradient, ledger);
  target.log_prior_gradient(theta, prior, of_prior);
  for (int w = 0; w < theta.width(); ++w) {
    auto const lane = static_cast<std::size_t>(w);
    value[lane] += prior[lane];
    if (!std::isfinite(value[lane])) value[lane] = minus_infinity;
    for (int p = 0; p < theta.rows(); ++p) gradient(p, w) = std::isfinite(value[lane]) ? gradient(p, w) + of_prior(p, w) : 0;
  }
  return {std::move(value), std::move(gradient)};
}

}  // namespace sysid::embed
