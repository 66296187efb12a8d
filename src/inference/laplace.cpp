// Newton's method and Laplace's approximation over lanes.
#include "inference/laplace.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/elementary.hpp"

namespace sysid {
namespace {

constexpr int most_parameters = 40;       // with a full second-difference curvature
constexpr double difference_width = 0.3;  // conditional sds: log density falls by 0.045, far above its rounding
constexpr double close_enough = 1e-8;     // Newton decrement: 1e-4 sd from the optimum
constexpr int most_steps = 30;

/// Value, gradient and minus the second derivatives of the log density, in units of `width`.
struct Local {
  double value = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;
  bool finite = true;
};

Local local_shape(Objective const& objective, Eigen::VectorXd const& theta, Eigen::VectorXd const& width, bool full,
                  Ledger& ledger) {
  Eigen::Index const n = theta.size();
  std::vector<Eigen::VectorXd> points = {theta};
  auto const moved = [&](Eigen::Index i, double a, Eigen::Index j, double b) {
    Eigen::VectorXd x = theta;
    x(i) += a * width(i);
    x(j) += b * width(j);
    return x;
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    points.push_back(moved(i, 1, i, 0));
    points.push_back(moved(i, -1, i, 0));
  }
  for (Eigen::Index i = 0; full && i < n; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      points.push_back(moved(i, 1, j, 1));
      points.push_back(moved(i, 1, j, -1));
      points.push_back(moved(i, -1, j, 1));
      points.push_back(moved(i, -1, j, -1));
    }
  }
  std::vector<double> const f = log_density_in_blocks(objective, to_lanes(points), ledger);
  Local local{f[0], Eigen::VectorXd(n), Eigen::MatrixXd::Zero(n, n)};
  local.finite = std::all_of(f.begin(), f.end(), [](double v) { return std::isfinite(v); });
  if (!local.finite) return local;
  std::size_t next = 1;
  for (Eigen::Index i = 0; i < n; ++i, next += 2) {
    local.gradient(i) = (f[next] - f[next + 1]) / 2;
    local.curvature(i, i) = 2 * f[0] - f[next] - f[next + 1];
  }
  for (Eigen::Index i = 0; full && i < n; ++i)
    for (Eigen::Index j = 0; j < i; ++j, next += 4)
      local.curvature(i, j) = local.curvature(j, i) = -(f[next] - f[next + 1] - f[next + 2] + f[next + 3]) / 4;
  return local;
}

/// Eigenvalues of a curvature in prior widths, held at or above the prior's own order: a direction that the data leave alone is a
/// few prior widths long, not infinite.
struct Spectrum {
  Eigen::VectorXd values;   // > 0
  Eigen::MatrixXd vectors;  // columns, in prior widths
  bool positive = true;
};

Spectrum spectrum_of(Eigen::MatrixXd const& curvature, Eigen::VectorXd const& scale) {
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> const solver(scale.asDiagonal() * curvature * scale.asDiagonal());
  Spectrum spectrum{solver.eigenvalues(), solver.eigenvectors()};
  constexpr double least = 1e-2;  // ten prior widths
  // Beside a stiff direction, rounding leaves this much in the others.
  double const noise = 1e-11 * solver.eigenvalues().cwiseAbs().maxCoeff();
  for (double& value : spectrum.values) {
    if (value < std::max(least, noise)) {
      spectrum.positive = false;
      value = std::max({std::fabs(value), least, noise});
    }
  }
  return spectrum;
}

Eigen::MatrixXd inverse(Spectrum const& s, Eigen::VectorXd const& scale) {
  Eigen::MatrixXd const vectors = scale.asDiagonal() * s.vectors;
  return vectors * s.values.cwiseInverse().asDiagonal() * vectors.transpose();
}

Eigen::VectorXd widths_from(Eigen::MatrixXd const& curvature, Eigen::VectorXd const& scale) {
  Eigen::VectorXd width(scale.size());
  for (Eigen::Index i = 0; i < width.size(); ++i) {
    double const bend = curvature(i, i);
    double const conditional = bend > 0 && std::isfinite(bend) ? 1 / std::sqrt(bend) : scale(i);
    width(i) = difference_width * std::min(conditional, scale(i));
  }
  return width;
}

void fill_declared(Target const& target, Eigen::VectorXd const& theta, Eigen::MatrixXd const& covariance, Mode& mode) {
  Eigen::Index const n = theta.size();
  std::vector<Eigen::VectorXd> points = {theta};
  Eigen::VectorXd const step = 1e-3 * covariance.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (double const sign : {1.0, -1.0}) {
      points.push_back(theta);
      points.back()(i) += sign * step(i);
    }
  }
  LaneArray const lanes = to_lanes(points);
  LaneArray declared(lanes.rows(), lanes.width());
  target.constrain(lanes, declared);
  Eigen::MatrixXd slope(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index p = 0; p < n; ++p)
      slope(p, i) = (declared(static_cast<int>(p), static_cast<int>(1 + 2 * i)) -
                     declared(static_cast<int>(p), static_cast<int>(2 + 2 * i))) /
                    (2 * step(i));
  Eigen::MatrixXd const spread = slope * covariance * slope.transpose();
  for (Eigen::Index p = 0; p < n; ++p) {
    mode.declared.push_back(declared(static_cast<int>(p), 0));
    mode.sd.push_back(std::sqrt(std::max(0.0, spread(p, p))));
  }
}

}  // namespace

Eigen::VectorXd theta_of(Mode const& mode) {
  return Eigen::Map<Eigen::VectorXd const>(mode.theta.data(), static_cast<Eigen::Index>(mode.theta.size()));
}

Eigen::MatrixXd covariance_of(Mode const& mode) {
  auto const n = static_cast<Eigen::Index>(mode.theta.size());
  return Eigen::Map<Eigen::MatrixXd const>(mode.covariance.data(), n, n);
}

double distance(Mode const& a, Mode const& b) {
  Eigen::VectorXd const gap = theta_of(a) - theta_of(b);
  return std::sqrt(std::max(0.0, gap.dot((covariance_of(a) + covariance_of(b)).ldlt().solve(gap))));
}

Mode laplace_mode(Objective const& objective, Eigen::VectorXd theta, Eigen::MatrixXd const& guess, Ledger& ledger) {
  Eigen::VectorXd const& scale = objective.scale;
  bool const full = objective.dimension() <= most_parameters;
  Eigen::VectorXd width = widths_from(guess, scale);
  Eigen::MatrixXd curvature = guess;
  double value = 0;
  for (int step = 0; step < most_steps; ++step) {
    Local const local = local_shape(objective, theta, width, full, ledger);
    value = local.value;
    if (!local.finite) {  // a failing region is near: look closer
      width *= 0.25;
      continue;
    }
    Eigen::VectorXd const gradient = local.gradient.cwiseQuotient(width);
    if (full) curvature = width.cwiseInverse().asDiagonal() * local.curvature * width.cwiseInverse().asDiagonal();
    Eigen::MatrixXd const covariance = inverse(spectrum_of(curvature, scale), scale);
    Eigen::VectorXd const move = covariance * gradient;
    Eigen::VectorXd const former = width;
    width = widths_from(curvature, scale);
    // Widths far from what the curvature here asks for would blur it: measure again before believing.
    bool const fitting = !full || ((width.array() < 3 * former.array()).all() && (width.array() > former.array() / 3).all());
    if (gradient.dot(move) < close_enough && (fitting || step + 1 == most_steps)) break;
    std::vector<Eigen::VectorXd> trials;
    for (double const part : {1.0, 0.5, 0.2, 0.05, 0.01}) trials.push_back(objective.clamp(theta + part * move));
    std::vector<double> const reached = log_density_in_blocks(objective, to_lanes(trials), ledger);
    auto const best = std::max_element(reached.begin(), reached.end());
    if (*best > value) {
      theta = trials[static_cast<std::size_t>(best - reached.begin())];
      value = *best;
    } else if (fitting) {
      break;
    }
  }
  Spectrum const spectrum = spectrum_of(curvature, scale);
  Eigen::MatrixXd const covariance = inverse(spectrum, scale);
  Eigen::Index const n = theta.size();
  Mode mode;
  mode.theta.assign(theta.data(), theta.data() + n);
  mode.covariance.assign(covariance.data(), covariance.data() + n * n);
  mode.log_density = value;
  mode.well_defined = spectrum.positive;
  mode.log_mass = value;
  for (Eigen::Index i = 0; i < n; ++i)
    mode.log_mass += elementary::log(scale(i)) + 0.5 * elementary::log(2 * std::numbers::pi / spectrum.values(i));
  fill_declared(objective.target, theta, covariance, mode);
  return mode;
}

}  // namespace sysid
