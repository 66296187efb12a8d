// One climber after another: the likelihood itself uses the threads there are.
#include "search/ascent.hpp"

#include <cmath>
#include <limits>

#include "gaussian_process/maximise.hpp"
#include "search/search_step.hpp"

namespace sysid {
namespace {

constexpr double tolerance = 1e-7;  // of the log density: a search ends 1e-3 sd from the optimum, Newton's method goes on
constexpr double width = 1e-3;      // prior widths: steps of the prior's and of the gradient's differences

/// The log density and its gradient in prior widths.
double density(Objective const& objective, Eigen::VectorXd const& theta, Eigen::VectorXd& gradient, Ledger& ledger) {
  Eigen::Index const n = theta.size();
  std::vector<Eigen::VectorXd> points = {theta};
  for (Eigen::Index p = 0; p < n; ++p)
    for (double const sign : {1.0, -1.0}) {
      points.push_back(theta);
      points.back()(p) += sign * width * objective.scale(p);
    }
  std::vector<double> const prior = objective.log_prior(to_lanes(points));
  LaneArray slopes(static_cast<int>(n), 1);
  double likelihood = 0;
  objective.target.log_likelihood_gradient(to_lanes({theta}), {&likelihood, 1}, slopes, ledger);
  gradient.resize(n);
  for (Eigen::Index p = 0; p < n; ++p) {
    auto const ahead = static_cast<std::size_t>(2 * p + 1);
    double const of_prior = (prior[ahead] - prior[ahead + 1]) / (2 * width);
    gradient(p) = slopes(static_cast<int>(p), 0) * objective.scale(p) + (std::isfinite(of_prior) ? of_prior : 0);
  }
  double const value = likelihood + prior[0];
  return std::isfinite(value) ? value : -std::numeric_limits<double>::infinity();
}

/// Minus the second derivatives of the log density.
Eigen::MatrixXd curvature_at(Objective const& objective, Eigen::VectorXd const& theta, Ledger& ledger) {
  Eigen::Index const n = theta.size();
  Eigen::MatrixXd curvature(n, n);
  Eigen::VectorXd ahead(n), behind(n);
  for (Eigen::Index p = 0; p < n; ++p) {
    Eigen::VectorXd place = theta;
    place(p) += width * objective.scale(p);
    double const f = density(objective, place, ahead, ledger);
    place(p) -= 2 * width * objective.scale(p);
    double const b = density(objective, place, behind, ledger);
    if (std::isfinite(f) && std::isfinite(b))
      curvature.col(p) = (behind - ahead) / (2 * width);
    else
      curvature.col(p) = Eigen::VectorXd::Unit(n, p);
  }
  Eigen::VectorXd const inverse = objective.scale.cwiseInverse();
  return inverse.asDiagonal() * (0.5 * (curvature + curvature.transpose())) * inverse.asDiagonal();
}

}  // namespace

void climb_by_gradient(Objective const& objective, std::vector<Climber>& climbers, int evaluations, Ledger& ledger,
                       std::function<bool()> const& stop, Journal* journal) {
  if (stop && stop()) return;
  ClimbingStep kept(journal, "climb by gradient", climbers, ledger);
  if (kept.over()) return;
  Eigen::VectorXd const low = objective.low.cwiseQuotient(objective.scale), high = objective.high.cwiseQuotient(objective.scale);
  for (std::size_t k = kept.place().first; k < climbers.size(); ++k) {
    Climber& climber = climbers[k];
    if (climber.done) continue;
    if (stop && stop()) return;
    kept.reached({0, k, {}});
    auto const f = [&](Eigen::VectorXd const& at, Eigen::VectorXd& gradient) {
      if (stop && stop()) {  // who asks for it does not wait for a search to end
        gradient.setZero();
        return -std::numeric_limits<double>::infinity();
      }
      return density(objective, at.cwiseProduct(objective.scale), gradient, ledger);
    };
    gaussian_process::Climb const found =
        gaussian_process::maximise(f, climber.theta.cwiseQuotient(objective.scale).cwiseMax(low).cwiseMin(high), low, high,
                                   {.scale = 1, .tolerance = tolerance, .most_evaluations = evaluations});
    if (found.value > climber.log_density) {
      climber.theta = found.at.cwiseProduct(objective.scale);
      climber.log_density = found.value;
    }
    climber.done = found.converged;
    if (climber.done) climber.curvature = curvature_at(objective, climber.theta, ledger);
  }
  if (stop && stop()) return;
  kept.finish();
}

}  // namespace sysid
