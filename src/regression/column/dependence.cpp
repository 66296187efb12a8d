// Gram-Schmidt in the user's order for what is exactly dependent, singular values for what nearly is.
#include "regression/column/dependence.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/text/words.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::regression {
namespace {

constexpr double dependent_below = 1e-8;
constexpr double condition_above = 100;

Eigen::MatrixXd unit_columns(Columns const& columns, std::vector<int> const& terms) {
  Eigen::MatrixXd unit(columns.terms.rows(), static_cast<Eigen::Index>(terms.size()));
  for (std::size_t k = 0; k < terms.size(); ++k) unit.col(static_cast<Eigen::Index>(k)) = columns.terms.col(terms[k]).normalized();
  return unit;
}

}  // namespace

std::string names_of(Equation const& equation, std::vector<int> const& terms) {
  std::vector<std::string> names;
  for (int const term : terms) names.push_back(equation.terms[static_cast<std::size_t>(term)].name);
  return quoted(names);
}

Usable independent_terms(Equation const& equation, Columns const& columns) {
  Usable usable;
  std::vector<int> order;
  for (bool const always : {true, false})
    for (std::size_t j = 0; j < equation.terms.size(); ++j)
      if (equation.terms[j].always == always) order.push_back(static_cast<int>(j));

  Eigen::Index const rows = columns.terms.rows();
  Eigen::MatrixXd basis(rows, 0);  // orthonormal
  std::vector<int> taken;          // whose columns span it
  for (int const j : order) {
    Eigen::VectorXd const column = columns.terms.col(j);
    std::string const name = names_of(equation, {j});
    Eigen::Index const bad = (!column.array().isFinite()).count();
    if (bad > 0) {
      Concern concern{.kind = Concern::Kind::not_finite, .terms = {j}, .value = static_cast<double>(bad)};
      concern.clause = fmt::format("{} is not finite in {} of {} rows", name, bad, rows);
      usable.concerns.push_back(std::move(concern));
      continue;
    }
    double const length = column.norm();
    if (!(length > 0)) {
      Concern concern{.kind = Concern::Kind::always_zero, .terms = {j}};
      concern.clause = fmt::format("{} is zero on the whole record", name);
      usable.concerns.push_back(std::move(concern));
      continue;
    }
    Eigen::VectorXd left = column / length;
    for (int pass = 0; pass < 2; ++pass) left -= basis * (basis.transpose() * left).eval();
    if (left.norm() > dependent_below) {
      basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
      basis.rightCols(1) = left.normalized();
      taken.push_back(j);
      continue;
    }
    Eigen::VectorXd const weights = OrthogonalTriangular(unit_columns(columns, taken)).solve(column / length);
    std::vector<int> others;
    for (std::size_t k = 0; k < taken.size(); ++k)
      if (std::abs(weights(static_cast<Eigen::Index>(k))) > 1e-6) others.push_back(taken[k]);
    Concern concern;
    concern.value = left.norm() > 0 ? 1 / left.norm() : 1 / dependent_below;
    if (others.size() == 1) {
      concern.kind = Concern::Kind::repeats;
      concern.terms = {others.front(), j};
      concern.clause = fmt::format("{} is a multiple of {} on these data and is left out", name, names_of(equation, others));
    } else {
      concern.kind = Concern::Kind::collinear;
      concern.terms = {j};
      concern.terms.insert(concern.terms.end(), others.begin(), others.end());
      concern.clause =
          fmt::format("{} is a linear combination of {} on these data and is left out", name, names_of(equation, others));
    }
    usable.concerns.push_back(std::move(concern));
  }
  usable.terms = taken;
  std::sort(usable.terms.begin(), usable.terms.end());
  return usable;
}

Concerns near_dependence(Equation const& equation, Columns const& columns, std::vector<int> const& terms) {
  Concerns concerns;
  if (terms.size() < 2) return concerns;
  SingularValues const svd = singular_values(OrthogonalTriangular(unit_columns(columns, terms)).triangle());
  Eigen::VectorXd const& values = svd.values;
  Eigen::MatrixXd share = svd.right.array().square().matrix() * values.array().square().inverse().matrix().asDiagonal();
  for (Eigen::Index k = 0; k < share.rows(); ++k) share.row(k) /= share.row(k).sum();
  for (Eigen::Index m = 0; m < values.size(); ++m) {
    double const index = values(0) / values(m);
    if (!(index > condition_above)) continue;
    Concern concern{.kind = Concern::Kind::nearly_collinear, .value = index};
    for (std::size_t k = 0; k < terms.size(); ++k)
      if (share(static_cast<Eigen::Index>(k), m) > 0.5) concern.terms.push_back(terms[k]);
    if (concern.terms.size() < 2) continue;
    concern.clause = fmt::format("{} can hardly be distinguished by these data (condition index {:.0f})",
                                 names_of(equation, concern.terms), index);
    concerns.push_back(std::move(concern));
  }
  return concerns;
}

std::vector<double> variance_inflation(Columns const& columns, std::vector<int> const& terms) {
  // The diagonal of the inverse of the scaled Gram matrix.
  auto const size = static_cast<Eigen::Index>(terms.size());
  std::vector<double> inflation;
  if (size == 0) return inflation;
  Eigen::MatrixXd const r = OrthogonalTriangular(unit_columns(columns, terms)).triangle();
  Eigen::MatrixXd const inverse = solve_upper(r, Eigen::MatrixXd::Identity(size, size));
  for (Eigen::Index k = 0; k < size; ++k) inflation.push_back(inverse.row(k).squaredNorm());
  return inflation;
}

}  // namespace sysid::regression
