// A least-squares problem reduced to a triangle: every subset of its columns can be solved without touching the rows again.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "regression/choice/selector.hpp"

namespace sysid::regression {

/// Columns scaled to unit root mean square, then Q^T [A b] of their Householder factorisation. The order of columns is the
/// problem's.
struct Triangle {
  Eigen::MatrixXd r;      // [J x J], upper triangle
  Eigen::VectorXd known;  // [J], Q^T b
  Eigen::VectorXd scale;  // [J] root mean square of the columns; the coefficients of the problem are those here over it
  double rest = 0;        // squared norm of the part of b that no column explains
  double total = 0;       // squared norm of b
  int rows = 0;           // K
};

/// K >= J.
Triangle reduce(LinearProblem const& problem);

/// Least squares on some columns of a triangle.
struct SubsetFit {
  Eigen::VectorXd coefficient;  // scaled
  Eigen::MatrixXd inverse;      // (A^T A)^-1, scaled
  double squares = 0;           // residual sum of squares
};
SubsetFit fit(Triangle const& triangle, std::vector<int> const& terms);
/// Its residual sum of squares alone.
double residual_squares(Triangle const& triangle, std::vector<int> const& terms);
/// The whole of Support but for evidence and probability.
Support support_of(Triangle const& triangle, std::vector<int> terms);

/// Backward elimination: from all terms, each time the one (not `always`) whose loss raises the squares least; supports
/// of up to 16 terms are then improved by exchanging terms. front(): all terms.
struct Elimination {
  std::vector<int> terms;   // before the loss, rising
  int lost = -1;            // the cheapest term; -1: only `always` ones are left
  double contribution = 0;  // sqrt(rise of squares / total)
};
std::vector<Elimination> eliminate(Triangle const& triangle, std::vector<char> const& always);

/// log_bayes_factor of a support against the `always` terms under the beta prime prior.
double default_log_evidence(Triangle const& triangle, std::vector<char> const& always, std::vector<int> const& terms);

}  // namespace sysid::regression
