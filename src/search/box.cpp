// The maps between the sampler's coordinates and those of the box.
#include "search/box.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"

namespace sysid {
namespace {

constexpr double end = 27.6;        // of theta: exp(-27.6) is 1e-12
constexpr double at_an_end = 1e-5;  // of z

}  // namespace

Box::Box(Objective const& objective) : middle_(objective.centre), lowest_(objective.low), highest_(objective.high) {
  auto const parameters = objective.target.parameters();
  bool const bounded = objective.objective_kind != ObjectiveKind::posterior;
  for (ParameterInfo const& parameter : parameters) {
    bool const below = std::isfinite(parameter.lower), above = std::isfinite(parameter.upper);
    kinds_.push_back(!bounded || (!below && !above) ? Kind::line : below && above ? Kind::interval : Kind::half_line);
  }
  for (Eigen::Index p = 0; p < middle_.size(); ++p) {
    Kind const kind = kinds_[static_cast<std::size_t>(p)];
    if (kind == Kind::interval) lowest_(p) = std::min(lowest_(p), -end), highest_(p) = std::max(highest_(p), end);
    if (kind == Kind::half_line) lowest_(p) = std::max(std::min(lowest_(p), middle_(p) - end), objective.nearest(p));
  }
  low_ = inside(lowest_);
  high_ = inside(highest_);
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
      double const v = u - middle_(p);
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
      theta(p) = middle_(p) + z(p) + elementary::log(-elementary::expm1(-z(p)));
  }
  return theta.cwiseMax(lowest_).cwiseMin(highest_);  // rounding at the ends, where the map is steep
}

bool Box::at_low(Eigen::VectorXd const& z, Eigen::Index p) const {
  return kinds_[static_cast<std::size_t>(p)] != Kind::line && z(p) < at_an_end;
}

bool Box::at_high(Eigen::VectorXd const& z, Eigen::Index p) const {
  return kinds_[static_cast<std::size_t>(p)] == Kind::interval && z(p) > 1 - at_an_end;
}

Eigen::VectorXd Box::slope(Eigen::VectorXd const& theta) const {
  Eigen::VectorXd slope = Eigen::VectorXd::Ones(theta.size());
  for (Eigen::Index p = 0; p < theta.size(); ++p) {
    double const u = kinds_[static_cast<std::size_t>(p)] == Kind::half_line ? theta(p) - middle_(p) : theta(p);
    double const tail = elementary::exp(-std::fabs(u));
    if (kinds_[static_cast<std::size_t>(p)] == Kind::interval) slope(p) = tail / ((1 + tail) * (1 + tail));
    if (kinds_[static_cast<std::size_t>(p)] == Kind::half_line) slope(p) = u > 0 ? 1 / (1 + tail) : tail / (1 + tail);
  }
  return slope;
}

}  // namespace sysid
