// Densities and draws of a normal distribution and of Student's t.
#include "inference/evidence/component.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid {

Component::Component(Eigen::VectorXd where, Eigen::MatrixXd const& covariance)
    : centre(std::move(where)), root(cholesky_or_diagonal(covariance)), log_volume(0) {
  for (double const each : root.diagonal()) log_volume += elementary::log(each);
  auto const n = static_cast<double>(centre.size());
  log_normal = -0.5 * n * elementary::log(2 * std::numbers::pi);
  log_student = elementary::lgamma((freedom + n) / 2) - elementary::lgamma(freedom / 2) -
                0.5 * n * elementary::log(freedom * std::numbers::pi);
}

void Component::log_densities(std::span<double const> squares, std::span<double> normal, std::span<double> student) const {
  auto const n = static_cast<double>(centre.size());
  for (std::size_t w = 0; w < squares.size(); ++w) student[w] = squares[w] / freedom;
  elementary::log1p_lanes(student.data(), student.data(), static_cast<int>(student.size()));
  for (std::size_t w = 0; w < squares.size(); ++w) {
    normal[w] = log_normal - 0.5 * squares[w] - log_volume;
    student[w] = log_student - 0.5 * (freedom + n) * student[w] - log_volume;
  }
}

Component::LogDensity Component::log_density(Eigen::VectorXd const& u) const {
  Eigen::VectorXd z = u - centre;
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) z(i) -= root(i, j) * z(j);
    z(i) /= root(i, i);
  }
  double const square = z.squaredNorm();
  auto const n = static_cast<double>(centre.size());
  double const student = log_student - 0.5 * (freedom + n) * elementary::log1p(square / freedom);
  return {log_normal - 0.5 * square - log_volume, student - log_volume};
}

LaneArray Component::whitened(ConstLanes theta) const {
  int const dimension = theta.rows();
  auto const width = static_cast<std::size_t>(theta.width());
  LaneArray z(dimension, theta.width());
  for (int i = 0; i < dimension; ++i) {  // forward substitution, lanes side by side
    auto const x = theta.row(i);
    auto const rest = z.row(i);
    for (std::size_t w = 0; w < width; ++w) rest[w] = x[w] - centre(i);
    for (int j = 0; j < i; ++j) {
      auto const before = z.row(j);
      double const factor = root(i, j);
      for (std::size_t w = 0; w < width; ++w) rest[w] -= factor * before[w];
    }
    for (std::size_t w = 0; w < width; ++w) rest[w] /= root(i, i);
  }
  return z;
}

Eigen::VectorXd Component::move(Stream& stream, bool student) const {
  Eigen::VectorXd z(centre.size());
  for (double& each : z) each = stream.normal();
  if (student) {
    double square = 0;
    for (int i = 0; i < static_cast<int>(freedom); ++i) {
      double const each = stream.normal();
      square += each * each;
    }
    z *= std::sqrt(freedom / square);
  }
  return root * z;
}

std::vector<double> squared_lengths(LaneArray const& z) {
  std::vector<double> squares(static_cast<std::size_t>(z.width()), 0.0);
  for (int i = 0; i < z.rows(); ++i) {
    auto const row = z.row(i);
    for (std::size_t w = 0; w < squares.size(); ++w) squares[w] += row[w] * row[w];
  }
  return squares;
}

}  // namespace sysid
