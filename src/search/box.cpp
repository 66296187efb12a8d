// The maps between the sampler's coordinates and those of the box.
#include "search/box.hpp"

#include <cmath>

#include "core/numeric/elementary.hpp"

namespace sysid {

Box::Box(Objective const& objective) : objective_(objective) {
  auto const parameters = objective.target.parameters();
  bool const bounded = objective.objective_kind != ObjectiveKind::posterior;
  for (ParameterInfo const& parameter : parameters) {
    bool const below = std::isfinite(parameter.lower), above = std::isfinite(parameter.upper);
    kinds_.push_back(!bounded || (!below && !above) ? Kind::line : below && above ? Kind::interval : Kind::half_line);
  }
  low_ = inside(objective.low);
  high_ = inside(objective.high);
  width_ = 0.5 * (inside(objective.centre + objective.scale) - inside(objective.centre - objective.scale));
}

Eigen::VectorXd Box::inside(Eigen::VectorXd const& theta) const {
  Eigen::VectorXd z = theta;
  for (Eigen::Index p = 0; p < z.size(); ++p) {
    double const u = theta(p);
    if (kinds_[static_cast<std::size_t>(p)] == Kind::interval) {
      double const tail = elementary::exp(-std::fabs(u));
      z(p) = u < 0 ? tail / (1 + tail) : 1 / (1 + tail);
    } else if (kinds_[static_cast<std::size_t>(p)] == Kind::half_line) {
      double const v = u - objective_.centre(p);
      z(p) = v > 0 ? v + elementary::log1p(elementary::exp(-v)) : elementary::log1p(elementary::exp(v));
    }
  }
  return z;
}

Eigen::VectorXd Box::outside(Eigen::VectorXd const& z) const {
  Eigen::VectorXd theta = z;
  for (Eigen::Index p = 0; p < z.size(); ++p) {
    if (kinds_[static_cast<std::size_t>(p)] == Kind::interval)
      theta(p) = elementary::log(z(p) / (1 - z(p)));
    else if (kinds_[static_cast<std::size_t>(p)] == Kind::half_line)
      theta(p) = objective_.centre(p) + z(p) + elementary::log(-elementary::expm1(-z(p)));
  }
  // Rounding at the ends, where the map is steep.
  return objective_.clamp(theta);
}

Eigen::VectorXd Box::slope(Eigen::VectorXd const& theta) const {
  Eigen::VectorXd slope = Eigen::VectorXd::Ones(theta.size());
  for (Eigen::Index p = 0; p < theta.size(); ++p) {
    double const u = kinds_[static_cast<std::size_t>(p)] == Kind::half_line ? theta(p) - objective_.centre(p) : theta(p);
    double const tail = elementary::exp(-std::fabs(u));
    if (kinds_[static_cast<std::size_t>(p)] == Kind::interval) slope(p) = tail / ((1 + tail) * (1 + tail));
    if (kinds_[static_cast<std::size_t>(p)] == Kind::half_line) slope(p) = u > 0 ? 1 / (1 + tail) : tail / (1 + tail);
  }
  return slope;
}

}  // namespace sysid
