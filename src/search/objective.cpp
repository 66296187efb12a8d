// The densities that a search maximises.
#include "search/objective.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/order.hpp"
#include "core/numeric/statistics.hpp"
#include "likelihood/improper_reference.hpp"
#include "search/search_step.hpp"

namespace sysid {

std::vector<double> Objective::log_prior(ConstLanes theta) const {
  std::vector<double> out(static_cast<std::size_t>(theta.width()), 0.0);
  if (objective_kind != ObjectiveKind::likelihood) target.log_prior(theta, out, objective_kind == ObjectiveKind::posterior);
  return out;
}

std::vector<double> Objective::log_density(ConstLanes theta, Ledger& ledger) const {
  std::vector<double> const prior = log_prior(theta);
  std::vector<double> out(prior.size());
  target.log_likelihood(theta, out, ledger);
  for (std::size_t w = 0; w < out.size(); ++w) {
    out[w] += prior[w];
    if (!std::isfinite(out[w])) out[w] = -std::numeric_limits<double>::infinity();
  }
  return out;
}

Objective make_objective(Target const& target, ObjectiveKind objective_kind, ConstLanes prior_draws) {
  int const dimension = target.dimension();
  Objective objective{target,
                      objective_kind,
                      Eigen::VectorXd::Ones(dimension),
                      Eigen::VectorXd::Zero(dimension),
                      Eigen::VectorXd::Constant(dimension, -infinity),
                      Eigen::VectorXd::Constant(dimension, infinity),
                      Eigen::VectorXd::Constant(dimension, -infinity)};
  for (int p = 0; p < dimension; ++p) {
    std::vector<double> finite;
    for (double const v : prior_draws.row(p))
      if (std::isfinite(v)) finite.push_back(v);
    if (finite.empty()) continue;
    sort_numbers(finite);
    double const above_middle = sorted_quantile(finite, 0.84), below_middle = sorted_quantile(finite, 0.16);
    double const spread = (above_middle - below_middle) / 2;
    objective.centre(p) = (above_middle + below_middle) / 2;
    if (spread > 0) objective.scale(p) = spread;
    ParameterInfo const& info = target.parameters()[static_cast<std::size_t>(p)];
    bool const below = std::isfinite(info.lower), above = std::isfinite(info.upper);
    // A bounded side lies at infinity of the coordinate; the end with one bound is always the lower one of log(x - a) and log(b -
    // x).
    // A density that rises for ever, as a Jacobian can where the prior does not fall, has no optimum to climb to.
    bool const rising = info.improper != Improper::no;
    if (below || above || rising) objective.low(p) = finite.front() - 3 * objective.scale(p);
    double const bound = below ? info.lower : info.upper;
    if (below != above && bound != 0) objective.nearest(p) = elementary::log(least_distance * std::fabs(bound));
    objective.low(p) = std::max(objective.low(p), objective.nearest(p));
    if ((below && above) || rising) objective.high(p) = finite.back() + 3 * objective.scale(p);
  }
  return objective;
}

Objective make_objective(Target const& target, ObjectiveKind objective_kind, std::uint64_t seed, std::uint64_t step) {
  constexpr int enough = 512;
  LaneArray draws(target.dimension(), enough);
  target.sample_prior({seed, Purpose::start, 0, step}, draws);
  return make_objective(target, objective_kind, draws);
}

LaneArray to_lanes(std::vector<Eigen::VectorXd> const& points) {
  int const rows = points.empty() ? 0 : static_cast<int>(points.front().size());
  LaneArray lanes(rows, static_cast<int>(points.size()));
  for (int w = 0; w < lanes.width(); ++w)
    for (int p = 0; p < rows; ++p) lanes(p, w) = points[static_cast<std::size_t>(w)](p);
  return lanes;
}

Eigen::VectorXd column(ConstLanes theta, int lane) {
  Eigen::VectorXd x(theta.rows());
  for (int p = 0; p < theta.rows(); ++p) x(p) = theta(p, lane);
  return x;
}

std::vector<double> log_density_in_blocks(Objective const& objective, ConstLanes theta, Ledger& ledger,
                                          std::function<bool()> const& stop, Journal* journal) {
  constexpr int block = 512;
  return kept_values(journal, "densities", theta.width(), block, ledger, stop,
                     [&](int first, int count) { return objective.log_density(theta.columns(first, count), ledger); });
}

}  // namespace sysid
