// Small dense least squares on column subsets.
#include "regression/choice/triangle.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "linear_algebra/decompositions.hpp"

namespace sysid::regression {

Triangle reduce(LinearProblem const& problem) {
  Triangle triangle;
  Eigen::Index const rows = problem.terms.rows(), count = problem.terms.cols();
  triangle.rows = static_cast<int>(rows);
  triangle.scale.resize(count);
  Eigen::MatrixXd scaled = problem.terms;
  for (Eigen::Index j = 0; j < count; ++j) {
    triangle.scale(j) = std::sqrt(scaled.col(j).squaredNorm() / static_cast<double>(rows));
    scaled.col(j) /= triangle.scale(j);
  }
  OrthogonalTriangular const qr(scaled);
  triangle.r = qr.triangle();
  Eigen::VectorXd const turned = qr.turned(problem.known);
  triangle.known = turned.head(count);
  triangle.rest = turned.tail(rows - count).squaredNorm();
  triangle.total = problem.known.squaredNorm();
  return triangle;
}

namespace {

Eigen::MatrixXd columns_of(Triangle const& triangle, std::vector<int> const& terms) {
  Eigen::MatrixXd columns(triangle.r.rows(), static_cast<Eigen::Index>(terms.size()));
  for (std::size_t k = 0; k < terms.size(); ++k) columns.col(static_cast<Eigen::Index>(k)) = triangle.r.col(terms[k]);
  return columns;
}

}  // namespace

SubsetFit fit(Triangle const& triangle, std::vector<int> const& terms) {
  auto const size = static_cast<Eigen::Index>(terms.size());
  SubsetFit result;
  if (size == 0) {
    result.squares = triangle.total;
    return result;
  }
  OrthogonalTriangular const qr(columns_of(triangle, terms));
  Eigen::VectorXd const turned = qr.turned(triangle.known);
  Eigen::MatrixXd const inverse = solve_upper(qr.triangle(), Eigen::MatrixXd::Identity(size, size));
  result.coefficient = inverse * turned.head(size);
  result.inverse = inverse * inverse.transpose();
  result.squares = triangle.rest + turned.tail(turned.size() - size).squaredNorm();
  return result;
}

double residual_squares(Triangle const& triangle, std::vector<int> const& terms) {
  if (terms.empty()) return triangle.total;
  auto const size = static_cast<Eigen::Index>(terms.size());
  Eigen::VectorXd const turned = OrthogonalTriangular(columns_of(triangle, terms)).turned(triangle.known);
  return triangle.rest + turned.tail(turned.size() - size).squaredNorm();
}

Support support_of(Triangle const& triangle, std::vector<int> terms) {
  SubsetFit const subset = fit(triangle, terms);
  Support support;
  auto const size = static_cast<Eigen::Index>(terms.size());
  double const variance = subset.squares / std::max(1, triangle.rows - static_cast<int>(size));
  support.noise_sd = std::sqrt(variance);
  support.coefficient = subset.coefficient;
  support.covariance = variance * subset.inverse;
  for (Eigen::Index k = 0; k < size; ++k) {
    double const scale = triangle.scale(terms[static_cast<std::size_t>(k)]);
    support.coefficient(k) /= scale;
    support.covariance.row(k) /= scale;
    support.covariance.col(k) /= scale;
  }
  support.terms = std::move(terms);
  return support;
}

namespace {

/// Terms whose loss raises the squares least, and by how much; -1: only `always` ones are there.
struct Cheapest {
  int term = -1;
  double rise = 0;
};

Cheapest cheapest(Triangle const& triangle, std::vector<char> const& always, std::vector<int> const& terms) {
  SubsetFit const subset = fit(triangle, terms);
  Cheapest found;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    if (always[static_cast<std::size_t>(terms[k])] != 0) continue;
    auto const i = static_cast<Eigen::Index>(k);
    double const rise = subset.coefficient(i) * subset.coefficient(i) / subset.inverse(i, i);
    if (found.term < 0 || rise < found.rise) found = {terms[k], rise};
  }
  return found;
}

/// `terms` with the one more that lowers the squares most.
std::vector<int> with_best(Triangle const& triangle, std::vector<int> const& terms) {
  std::vector<int> best;
  double least = 0;
  for (int j = 0; j < triangle.r.cols(); ++j) {
    auto const place = std::lower_bound(terms.begin(), terms.end(), j);
    if (place != terms.end() && *place == j) continue;
    std::vector<int> more = terms;
    more.insert(more.begin() + (place - terms.begin()), j);
    double const squares = residual_squares(triangle, more);
    if (!best.empty() && !(squares < least)) continue;
    best = std::move(more);
    least = squares;
  }
  return best;
}

/// A term comes in, the cheapest goes out, as long as that lowers the squares: among many collinear terms the way down from all of
/// them has often lost one that the short equations need.
void exchange(Triangle const& triangle, std::vector<char> const& always, std::vector<int>& terms) {
  double squares = residual_squares(triangle, terms);
  while (terms.size() < static_cast<std::size_t>(triangle.r.cols())) {
    std::vector<int> other = with_best(triangle, terms);
    std::erase(other, cheapest(triangle, always, other).term);
    double const lower = residual_squares(triangle, other);
    if (!(lower < squares * (1 - 1e-9))) return;
    terms = std::move(other);
    squares = lower;
  }
}

/// Supports of up to this many terms are improved by exchanges.
constexpr std::size_t exchanged_up_to = 16;

}  // namespace

std::vector<Elimination> eliminate(Triangle const& triangle, std::vector<char> const& always) {
  std::vector<int> terms;
  for (int j = 0; j < triangle.r.cols(); ++j) terms.push_back(j);
  std::vector<Elimination> path;
  for (;;) {
    if (terms.size() <= exchanged_up_to) exchange(triangle, always, terms);
    Cheapest const lost = cheapest(triangle, always, terms);
    path.push_back({terms, lost.term, triangle.total > 0 ? std::sqrt(lost.rise / triangle.total) : 0});
    if (lost.term < 0) return path;
    std::erase(terms, lost.term);
  }
}

double default_log_evidence(Triangle const& triangle, std::vector<char> const& always, std::vector<int> const& terms) {
  std::vector<int> base;
  for (std::size_t j = 0; j < always.size(); ++j)
    if (always[j] != 0) base.push_back(static_cast<int>(j));
  double const n = triangle.rows - static_cast<double>(base.size());
  return log_bayes_factor(CoefficientPrior::beta_prime, n, static_cast<double>(terms.size() - base.size()),
                          residual_squares(triangle, terms), residual_squares(triangle, base), n);
}

}  // namespace sysid::regression
