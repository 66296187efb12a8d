// Prior and likelihood put together, and what lies outside or at the bounds of a prior.
#include "embed/density_values.hpp"

#include <cmath>
#include <limits>

namespace sysid::embed {
namespace {

constexpr double minus_infinity = -std::numeric_limits<double>::infinity();
/// Derivatives where there is no density. Zero would tell an optimiser that it has arrived.
constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

/// The coordinate that stands for a bound: as far out as `constrain` is made for.
constexpr double at_bound = 700;
/// A prior is asked at two coordinates close to a bound how it goes on towards it. The closest value to a bound of 0 is the
/// smallest double; to another bound a few units in the last place, since differences of doubles are no smaller.
struct Approach {
  double far, near;
};
constexpr Approach to_lower = {650, 700}, to_upper = {30, 34};
/// By how much the log of a prior that has a limit may change between the two. Where it goes as a power of the distance to zero or
/// to infinity, it changes by that power times the difference of the coordinates.
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

bool is_bound(ConstLanes values, ConstLanes theta, int p, int w) { return std::isinf(theta(p, w)) && std::isfinite(values(p, w)); }

/// Coordinates at which finite values have infinite ones, the bounds of supports, as finite ones.
LaneArray with_bounds(ConstLanes values, ConstLanes theta) {
  LaneArray out(theta.rows(), theta.width());
  for (int p = 0; p < theta.rows(); ++p)
    for (int w = 0; w < theta.width(); ++w)
      out(p, w) = is_bound(values, theta, p, w) ? std::copysign(at_bound, theta(p, w)) : theta(p, w);
  return out;
}

/// Where the log of the prior goes as parameters approach the bounds they lie at, [W]: -infinity, +infinity, or 0 where it has a
/// limit or nothing lies at a bound. A density that one parameter takes to zero is zero, whatever others do to it.
std::vector<double> prior_at_bounds(Target const& target, ConstLanes values, ConstLanes theta, ConstLanes at) {
  std::vector<double> goes(static_cast<std::size_t>(theta.width()), 0);
  Ledger none;
  for (int p = 0; p < theta.rows(); ++p) {
    std::vector<int> lanes;
    for (int w = 0; w < theta.width(); ++w)
      if (is_bound(values, theta, p, w)) lanes.push_back(w);
    if (lanes.empty()) continue;
    LaneArray far = columns(at, lanes), near = far;
    for (int i = 0; i < far.width(); ++i) {
      Approach const approach = far(p, i) > 0 ? to_upper : to_lower;
      far(p, i) = std::copysign(approach.far, far(p, i));
      near(p, i) = std::copysign(approach.near, near(p, i));
    }
    std::vector<double> const before = usable_log_density(target, far, Part::prior, false, none);
    std::vector<double> const after = usable_log_density(target, near, Part::prior, false, none);
    for (std::size_t i = 0; i < lanes.size(); ++i) {
      double& of_lane = goes[static_cast<std::size_t>(lanes[i])];
      double const change = after[i] - before[i];
      if (change > limit_change && of_lane == 0) of_lane = -minus_infinity;
      if (!(change >= -limit_change)) of_lane = minus_infinity;
    }
  }
  return goes;
}

}  // namespace

std::vector<double> log_density(Target const& target, ConstLanes theta, Part part, Ledger& ledger) {
  return usable_log_density(target, theta, part, true, ledger);
}

std::vector<double> declared_log_density(Target const& target, ConstLanes values, Part part, Ledger& ledger) {
  LaneArray theta(values.rows(), values.width());
  target.unconstrain(values, theta);
  LaneArray const at = with_bounds(values, theta);
  std::vector<double> density = usable_log_density(target, at, part, false, ledger);
  if (part == Part::likelihood) return density;
  std::vector<double> const goes = prior_at_bounds(target, values, theta, at);
  for (std::size_t w = 0; w < density.size(); ++w)
    if (goes[w] != 0 && density[w] != minus_infinity) density[w] = goes[w];
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
    for (int p = 0; p < theta.rows(); ++p)
      gradient(p, w) = std::isfinite(value[lane]) ? gradient(p, w) + of_prior(p, w) : undefined;
  }
  return {std::move(value), std::move(gradient)};
}

ResidualsAndJacobian residuals_with_jacobian(Target const& target, ConstLanes theta, Ledger& ledger) {
  int const count = target.residual_count();
  LaneArray residuals(count, theta.width()), jacobian(count * theta.rows(), theta.width());
  target.residuals_with_jacobian(theta, residuals, jacobian, ledger);
  for (int w = 0; w < theta.width(); ++w) {
    bool finite = true;
    for (int r = 0; r < count; ++r) finite = finite && std::isfinite(residuals(r, w));
    for (int i = 0; !finite && i < jacobian.rows(); ++i) jacobian(i, w) = undefined;
  }
  return {std::move(residuals), std::move(jacobian)};
}

}  // namespace sysid::embed
