// Regression as the textbook prints it, in extended precision and by other means than the library's: Gauss-Jordan inverse and
// determinant, the mean's coefficients as a part of the covariance.
#pragma once
#include <cmath>
#include <vector>

#include "gaussian_process/made.hpp"
#include "gaussian_process/observations.hpp"

namespace sysid::gaussian_process::textbook {

using Real = long double;
using Matrix = std::vector<std::vector<Real>>;

inline Matrix zeros(std::size_t rows, std::size_t columns) { return Matrix(rows, std::vector<Real>(columns, 0)); }

inline Matrix from(Eigen::MatrixXd const& a) {
  Matrix result = zeros(static_cast<std::size_t>(a.rows()), static_cast<std::size_t>(a.cols()));
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < a.cols(); ++j) result[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = a(i, j);
  return result;
}

inline Matrix product(Matrix const& a, Matrix const& b) {
  Matrix result = zeros(a.size(), b[0].size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < b.size(); ++k)
      for (std::size_t j = 0; j < b[0].size(); ++j) result[i][j] += a[i][k] * b[k][j];
  return result;
}

inline Matrix transposed(Matrix const& a) {
  Matrix result = zeros(a[0].size(), a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < a[0].size(); ++j) result[j][i] = a[i][j];
  return result;
}

/// The inverse, and the logarithm of the determinant's absolute value.
inline Matrix inverse(Matrix a, Real& log_determinant) {
  std::size_t const n = a.size();
  Matrix result = zeros(n, n);
  for (std::size_t i = 0; i < n; ++i) result[i][i] = 1;
  log_determinant = 0;
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c; r < n; ++r)
      if (std::fabs(a[r][c]) > std::fabs(a[pivot][c])) pivot = r;
    std::swap(a[c], a[pivot]);
    std::swap(result[c], result[pivot]);
    log_determinant += std::log(std::fabs(a[c][c]));
    for (std::size_t r = 0; r < n; ++r) {
      if (r == c) continue;
      Real const factor = a[r][c] / a[c][c];
      for (std::size_t j = 0; j < n; ++j) {
        a[r][j] -= factor * a[c][j];
        result[r][j] -= factor * result[c][j];
      }
    }
    Real const scale = 1 / a[c][c];
    for (std::size_t j = 0; j < n; ++j) {
      a[c][j] *= scale;
      result[c][j] *= scale;
    }
  }
  return result;
}

/// K + noise^2 I + H S^2 H^T, all prior sds finite.
inline Matrix covariance_of(Covariance const& covariance, Observations const& o, Numbers parameters) {
  Numbers const own = parameters.first(parameters.size() - 1);
  Matrix k = from(covariance.between(o.inputs, o.inputs, own));
  for (std::size_t i = 0; i < k.size(); ++i) {
    k[i][i] += static_cast<Real>(parameters.back()) * parameters.back();
    for (std::size_t j = 0; j < k.size(); ++j)
      for (Eigen::Index c = 0; c < o.columns.cols(); ++c) {
        Real const sd = o.prior_sd[c];
        k[i][j] += sd * sd * o.columns(static_cast<Eigen::Index>(i), c) * o.columns(static_cast<Eigen::Index>(j), c);
      }
  }
  return k;
}

inline Matrix centred(Observations const& o) {
  Matrix result = zeros(static_cast<std::size_t>(o.values.size()), 1);
  for (Eigen::Index i = 0; i < o.values.size(); ++i) {
    Real sum = o.values[i];
    for (Eigen::Index c = 0; c < o.columns.cols(); ++c) sum -= static_cast<Real>(o.columns(i, c)) * o.prior_mean[c];
    result[static_cast<std::size_t>(i)][0] = sum;
  }
  return result;
}

/// Rasmussen & Williams 2006, eq. 2.30.
inline double log_marginal_likelihood(Covariance const& covariance, Observations const& o, Numbers parameters) {
  Real log_determinant = 0;
  Matrix const y = centred(o), k = inverse(covariance_of(covariance, o, parameters), log_determinant);
  Real const quadratic = product(transposed(y), product(k, y))[0][0];
  return static_cast<double>(-0.5L * quadratic - 0.5L * log_determinant -
                             0.5L * static_cast<Real>(y.size()) * std::log(2 * std::acos(Real(-1))));
}

/// Rasmussen & Williams 2006, eq. 2.25, 2.26: mean and covariance at the places.
struct Posterior {
  Matrix mean, covariance;
};
inline Posterior posterior(Covariance const& covariance, Observations const& o, Numbers parameters, Places const& places) {
  Numbers const own = parameters.first(parameters.size() - 1);
  auto const with_mean = [&](Eigen::MatrixXd const& k, Eigen::MatrixXd const& left, Eigen::MatrixXd const& right) {
    Matrix result = from(k);
    for (std::size_t i = 0; i < result.size(); ++i)
      for (std::size_t j = 0; j < result[0].size(); ++j)
        for (Eigen::Index c = 0; c < o.columns.cols(); ++c)
          result[i][j] += static_cast<Real>(o.prior_sd[c]) * o.prior_sd[c] * left(static_cast<Eigen::Index>(i), c) *
                          right(static_cast<Eigen::Index>(j), c);
    return result;
  };
  Real unused = 0;
  Matrix const inverted = inverse(covariance_of(covariance, o, parameters), unused);
  Matrix const cross = with_mean(covariance.between(places.inputs, o.inputs, own), places.columns, o.columns);
  Matrix const prior = with_mean(covariance.between(places.inputs, places.inputs, own), places.columns, places.columns);
  Matrix const gain = product(cross, inverted);
  Posterior result{product(gain, centred(o)), product(gain, transposed(cross))};
  for (std::size_t i = 0; i < prior.size(); ++i) {
    for (Eigen::Index c = 0; c < o.columns.cols(); ++c)
      result.mean[i][0] += static_cast<Real>(places.columns(static_cast<Eigen::Index>(i), c)) * o.prior_mean[c];
    for (std::size_t j = 0; j < prior.size(); ++j) result.covariance[i][j] = prior[i][j] - result.covariance[i][j];
  }
  return result;
}

}  // namespace sysid::gaussian_process::textbook
