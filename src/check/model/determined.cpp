// Rank of the mass matrix at points without symmetry.
#include "check/model/determined.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace sysid {
namespace {

using Matrix = std::vector<std::vector<double>>;

constexpr int points = 4;
/// A pivot below this part of the largest entry is a rounding error: rows of a few terms each lose a few digits of sixteen. Rows
/// and columns are of size 1 beforehand.
constexpr double rounding = 1e-10;

/// Between 0.5 and 1.5, different for every leaf and point (multiples of the golden ratio lie apart).
double value_at(NodeId leaf, int point) {
  double const turns = 0.6180339887498949 * (leaf + 1.0) + 0.4142135623730951 * (point + 1.0);
  return 0.5 + turns - std::floor(turns);
}

/// Divides rows and columns by powers of two near their largest entries until all are near 1: units of equations and unknowns say
/// nothing of rank (Ruiz 2001).
void equilibrate(Matrix& matrix) {
  std::size_t const n = matrix.size();
  auto const exponent = [](double largest) { return largest > 0 && std::isfinite(largest) ? std::ilogb(largest) : 0; };
  for (int pass = 0; pass < 20; ++pass) {
    bool changed = false;
    std::vector<int> row(n), column(n);
    for (std::size_t i = 0; i < n; ++i) {
      double in_row = 0, in_column = 0;
      for (std::size_t j = 0; j < n; ++j) {
        in_row = std::fmax(in_row, std::fabs(matrix[i][j]));
        in_column = std::fmax(in_column, std::fabs(matrix[j][i]));
      }
      // Half of each, so that one scaling does not undo the other; the last factor of two is no matter.
      row[i] = exponent(in_row) / 2, column[i] = exponent(in_column) / 2;
      changed = changed || row[i] != 0 || column[i] != 0;
    }
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) matrix[i][j] = std::ldexp(matrix[i][j], -row[i] - column[j]);
    if (!changed) return;
  }
}

/// The column that elimination with full pivoting finds no pivot for; -1 when there is one for each; -2 when a number is not
/// finite.
int column_without_pivot(Matrix matrix) {
  equilibrate(matrix);
  std::size_t const n = matrix.size();
  std::vector<std::size_t> columns;
  for (std::size_t j = 0; j < n; ++j) columns.push_back(j);
  double largest = 0;
  for (std::size_t step = 0; step < n; ++step) {
    std::size_t row = step, column = step;
    for (std::size_t i = step; i < n; ++i)
      for (std::size_t j = step; j < n; ++j) {
        if (!std::isfinite(matrix[i][columns[j]])) return -2;
        if (std::fabs(matrix[i][columns[j]]) > std::fabs(matrix[row][columns[column]])) row = i, column = j;
      }
    std::swap(matrix[step], matrix[row]);
    std::swap(columns[step], columns[column]);
    double const pivot = matrix[step][columns[step]];
    if (step == 0) largest = std::fabs(pivot);
    if (!(std::fabs(pivot) > rounding * largest)) return static_cast<int>(columns[step]);
    for (std::size_t i = step + 1; i < n; ++i) {
      double const factor = matrix[i][columns[step]] / pivot;
      for (std::size_t j = step; j < n; ++j) matrix[i][columns[j]] -= factor * matrix[step][columns[j]];
    }
  }
  return -1;
}

}  // namespace

std::optional<int> undetermined_unknown(Graph& graph, std::span<NodeId const> residuals) {
  std::size_t const n = residuals.size();
  std::vector<NodeId> derivatives;
  for (NodeId const residual : residuals)
    for (std::size_t j = 0; j < n; ++j)
      derivatives.push_back(graph.differentiate(residual, graph.leaf(LeafKind::unknown, static_cast<int>(j))));
  std::optional<int> open;
  for (int point = 0; point < points; ++point) {
    std::vector<double> const values = graph.evaluate(derivatives, [&](NodeId leaf) { return value_at(leaf, point); });
    Matrix matrix(n, std::vector<double>(n));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) matrix[i][j] = values[i * n + j];
    int const column = column_without_pivot(std::move(matrix));
    if (column == -1) return std::nullopt;
    if (column >= 0) open = column;
  }
  return open;
}

}  // namespace sysid
