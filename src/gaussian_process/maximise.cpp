// NLopt's interface, and when a climb counts as arrived.
#include "gaussian_process/maximise.hpp"

#include <nlopt.h>

#include <cmath>
#include <exception>
#include <limits>
#include <memory>

namespace sysid::gaussian_process {
namespace {

/// A gradient this small, per unit of the scale, ends a climb that rounding has stopped.
constexpr double flat = 1e-5;

struct Running {
  Density const& f;
  double scale;
  nlopt_opt optimizer;
  Climb best;
  double worst = -std::numeric_limits<double>::infinity();  // largest finite value of what is minimised
  std::exception_ptr thrown;
};

/// What NLopt calls: minus f over the scale. It is C: nothing may be thrown through it.
double minus(unsigned size, double const* at, double* gradient, void* data) {
  Running& running = *static_cast<Running*>(data);
  auto const count = static_cast<Eigen::Index>(size);
  Eigen::VectorXd const point = Eigen::Map<Eigen::VectorXd const>(at, count);
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(count);
  double value = -std::numeric_limits<double>::infinity();
  try {
    value = running.f(point, slope);
  } catch (...) {
    running.thrown = std::current_exception();
    nlopt_force_stop(running.optimizer);
  }
  ++running.best.evaluations;
  if (!std::isfinite(value) || !slope.allFinite()) {
    // A wall, higher than all that was seen, at which the line search turns back; an infinite one would spoil its interpolation.
    if (gradient != nullptr) Eigen::Map<Eigen::VectorXd>(gradient, count).setZero();
    return std::isfinite(running.worst) ? running.worst + 1 + std::fabs(running.worst) : 1;
  }
  if (value > running.best.value) {
    running.best.value = value;
    running.best.at = point;
    running.best.gradient = slope;
  }
  double const minimised = -value / running.scale;
  running.worst = std::max(running.worst, minimised);
  if (gradient != nullptr) Eigen::Map<Eigen::VectorXd>(gradient, count) = -slope / running.scale;
  return minimised;
}

/// The largest slope along which the bounds leave room.
double free_slope(Climb const& climb, Eigen::VectorXd const& lower, Eigen::VectorXd const& upper) {
  double largest = 0;
  for (Eigen::Index i = 0; i < climb.at.size(); ++i) {
    double const slope = climb.gradient[i];
    if ((slope > 0 && climb.at[i] < upper[i]) || (slope < 0 && climb.at[i] > lower[i]))
      largest = std::max(largest, std::fabs(slope));
  }
  return largest;
}

}  // namespace

Climb maximise(Density const& f, Eigen::VectorXd const& start, Eigen::VectorXd const& lower, Eigen::VectorXd const& upper,
               ClimbSettings const& settings) {
  std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> const optimizer(
      nlopt_create(NLOPT_LD_LBFGS, static_cast<unsigned>(start.size())), &nlopt_destroy);
  Running running{f, settings.scale, optimizer.get(), {}, -std::numeric_limits<double>::infinity(), nullptr};
  running.best.at = start;
  running.best.gradient = Eigen::VectorXd::Zero(start.size());
  running.best.value = -std::numeric_limits<double>::infinity();
  nlopt_set_min_objective(optimizer.get(), &minus, &running);
  nlopt_set_lower_bounds(optimizer.get(), lower.data());
  nlopt_set_upper_bounds(optimizer.get(), upper.data());
  nlopt_set_ftol_abs(optimizer.get(), settings.tolerance / settings.scale);
  nlopt_set_maxeval(optimizer.get(), settings.most_evaluations);
  Eigen::VectorXd at = start;
  double reached = 0;
  nlopt_result const result = nlopt_optimize(optimizer.get(), at.data(), &reached);
  if (running.thrown) std::rethrow_exception(running.thrown);
  if (!std::isfinite(running.best.value)) return running.best;
  bool const ended = result == NLOPT_SUCCESS || result == NLOPT_FTOL_REACHED || result == NLOPT_XTOL_REACHED;
  running.best.converged = ended || free_slope(running.best, lower, upper) < flat * settings.scale;
  return running.best;
}

}  // namespace sysid::gaussian_process
