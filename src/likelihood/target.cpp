// Derivatives by central differences, for targets that have no better ones.
#include "likelihood/target.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"

namespace sysid {
namespace {

constexpr int prior_draws = 256;
constexpr std::uint64_t scale_step = 97;  // of Purpose::start

std::vector<double> scaled(std::vector<double> values, double by) {
  for (double& value : values) value *= by;
  return values;
}

/// Values of one function at moved lanes, as values and gradients.
void take_differences(std::span<double const> values, std::vector<double> const& steps, std::span<double> out, Lanes gradient) {
  std::size_t const columns = 2 * steps.size() + 1;
  for (std::size_t w = 0; w < out.size(); ++w) {
    double const* const f = values.data() + w * columns;
    out[w] = f[0];
    for (std::size_t p = 0; p < steps.size(); ++p)
      gradient(static_cast<int>(p), static_cast<int>(w)) = central_slope(f[2 * p + 1], f[0], f[2 * p + 2], steps[p]);
  }
}

}  // namespace

LaneArray moved_lanes(ConstLanes theta, std::span<int const> coordinates, std::span<double const> steps) {
  int const columns = 2 * static_cast<int>(coordinates.size()) + 1;
  LaneArray points(theta.rows(), columns * theta.width());
  for (int p = 0; p < theta.rows(); ++p)
    for (int w = 0; w < theta.width(); ++w)
      for (int c = 0; c < columns; ++c) points(p, w * columns + c) = theta(p, w);
  for (std::size_t k = 0; k < coordinates.size(); ++k) {
    int const p = coordinates[k], c = 2 * static_cast<int>(k) + 1;
    double const step = steps[static_cast<std::size_t>(p)];
    for (int w = 0; w < theta.width(); ++w) {
      points(p, w * columns + c) = theta(p, w) + step;
      points(p, w * columns + c + 1) = theta(p, w) - step;
    }
  }
  return points;
}

LaneArray moved_lanes(ConstLanes theta, std::span<double const> steps) {
  std::vector<int> all(static_cast<std::size_t>(theta.rows()));
  std::iota(all.begin(), all.end(), 0);
  return moved_lanes(theta, all, steps);
}

double scale_residual(int samples, double log_density) {
  double const offset = 100.0 * samples + 1000.0;
  return std::sqrt(2 * std::max(offset - log_density, 0.0));
}

double central_slope(double ahead, double at, double behind, double step) {
  if (!std::isfinite(at)) return 0;
  bool const up = std::isfinite(ahead), down = std::isfinite(behind);
  if (!up && !down) return 0;
  return ((up ? ahead : at) - (down ? behind : at)) / ((up ? step : 0) + (down ? step : 0));
}

LaneArray coordinates_of(Target const& target, std::span<double const> declared) {
  LaneArray values(target.dimension(), 1), theta(target.dimension(), 1);
  for (int p = 0; p < target.dimension(); ++p) values(p, 0) = declared[static_cast<std::size_t>(p)];
  target.unconstrain(values, theta);
  return theta;
}

double difference_width(Target const& target) { return std::clamp(0.1 * std::sqrt(target.roughness()), 1e-5, 1e-3); }

std::vector<double> const& Target::prior_widths() const {
  return prior_widths_.get([&] {
    LaneArray draws(dimension(), prior_draws);
    sample_prior({0, Purpose::start, 0, scale_step}, draws);
    std::vector<double> widths;
    for (int p = 0; p < dimension(); ++p) {
      std::vector<double> finite;
      for (double const v : draws.row(p))
        if (std::isfinite(v)) finite.push_back(v);
      double const spread = finite.empty() ? 0 : (quantile(finite, 0.84) - quantile(finite, 0.16)) / 2;
      widths.push_back(spread > 0 ? spread : 1);
    }
    return widths;
  });
}

std::vector<double> Target::difference_steps() const { return scaled(prior_widths(), difference_width(*this)); }

void Target::log_likelihood_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const {
  std::vector<double> const steps = difference_steps();
  LaneArray const points = moved_lanes(theta, steps);
  std::vector<double> values(static_cast<std::size_t>(points.width()));
  log_likelihood(points, values, ledger);
  take_differences(values, steps, out, gradient);
}

void Target::log_prior_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, bool jacobian) const {
  constexpr double width = 1e-5;
  std::vector<double> const steps = scaled(prior_widths(), width);
  LaneArray const points = moved_lanes(theta, steps);
  std::vector<double> values(static_cast<std::size_t>(points.width()));
  log_prior(points, values, jacobian);
  take_differences(values, steps, out, gradient);
}

void Target::residuals_with_jacobian(ConstLanes theta, Lanes out, Lanes jacobian, Ledger& ledger) const {
  std::vector<double> const steps = difference_steps();
  LaneArray const points = moved_lanes(theta, steps);
  LaneArray rows(residual_count(), points.width());
  residuals(points, rows, ledger);
  int const dimension = theta.rows(), columns = 2 * dimension + 1;
  for (int r = 0; r < rows.rows(); ++r)
    for (int w = 0; w < theta.width(); ++w) {
      double const* const f = rows.row(r).data() + w * columns;
      out(r, w) = f[0];
      for (int p = 0; p < dimension; ++p)
        jacobian(r * dimension + p, w) = central_slope(f[2 * p + 1], f[0], f[2 * p + 2], steps[static_cast<std::size_t>(p)]);
    }
}

void Target::gauss_newton(ConstLanes theta, std::span<double const> steps, Lanes gradient, Lanes curvature, Ledger& ledger) const {
  LaneArray const points = moved_lanes(theta, steps);
  LaneArray rows(residual_count(), points.width());
  residuals(points, rows, ledger);
  int const dimension = theta.rows(), columns = 2 * dimension + 1;
  Eigen::VectorXd centre(rows.rows());
  Eigen::MatrixXd jacobian(rows.rows(), dimension);
  for (int w = 0; w < theta.width(); ++w) {
    for (int r = 0; r < rows.rows(); ++r) {
      double const* const f = rows.row(r).data() + w * columns;
      centre(r) = f[0];
      for (int p = 0; p < dimension; ++p)
        jacobian(r, p) = central_slope(f[2 * p + 1], f[0], f[2 * p + 2], steps[static_cast<std::size_t>(p)]);
    }
    bool const finite = centre.allFinite();
    Eigen::VectorXd const slope = -jacobian.transpose() * centre;
    Eigen::MatrixXd const squares = jacobian.transpose() * jacobian;
    for (int p = 0; p < dimension; ++p) {
      gradient(p, w) = finite ? slope(p) : 0;
      for (int q = 0; q < dimension; ++q) curvature(p * dimension + q, w) = finite ? squares(p, q) : 0;
    }
  }
}

}  // namespace sysid
