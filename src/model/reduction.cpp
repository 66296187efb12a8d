// Gaussian elimination on expressions; structural zeros stay zeros, so an uncoupled system costs nothing.
#include "model/reduction.hpp"

#include <algorithm>
#include <cmath>

namespace sysid {
namespace {

bool has_unknown(Graph const& graph, NodeId root) {
  return graph.depends(root,
                       [](Node const& node) { return node.operation == Operation::leaf && node.leaf_kind == LeafKind::unknown; });
}

// The smaller, the better a pivot: constants, expressions of parameters, anything that moves with the state.
int pivot_rank(Graph const& graph, NodeId id) {
  if (graph.is_constant(id, 0)) return 3;
  if (graph.constant_value(id)) return 0;
  bool const moves = graph.depends(
      id, [](Node const& node) { return node.operation == Operation::leaf && node.leaf_kind != LeafKind::parameter; });
  return moves ? 2 : 1;
}

}  // namespace

std::variant<std::vector<NodeId>, ReductionFailure> solve_for_unknowns(Graph& graph, std::span<NodeId const> residuals) {
  std::size_t const n = residuals.size();
  NodeId const zero = graph.constant(0);
  std::vector<std::vector<NodeId>> matrix(n, std::vector<NodeId>(n, zero));
  std::vector<NodeId> right(n, zero);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      NodeId const slope = graph.differentiate(residuals[i], graph.leaf(LeafKind::unknown, static_cast<int>(j)));
      if (has_unknown(graph, slope))
        return ReductionFailure{ReductionFailure::Kind::nonlinear, static_cast<int>(i), static_cast<int>(j)};
      matrix[i][j] = graph.negate(slope);
    }
    right[i] = graph.substitute(residuals[i], [&](NodeId leaf) -> std::optional<NodeId> {
      return graph[leaf].leaf_kind == LeafKind::unknown ? std::optional(zero) : std::nullopt;
    });
    // abs(y'') and the like: the slope is free of unknowns by our derivative rules only where the expression is really linear.
    if (has_unknown(graph, right[i])) return ReductionFailure{ReductionFailure::Kind::nonlinear, static_cast<int>(i), 0};
  }
  std::vector<std::size_t> row_of(n, n);  // the equation that determines unknown j
  std::vector<bool> used(n, false);
  // A constant counts by its share of the largest one in its row, so that the units of an equation do not matter: one that is
  // small there would drown what the others say (1e-20*a + b = 1, 2*a + b = 3).
  auto const share = [&](std::size_t i, std::size_t j) {
    double largest = 0;
    for (std::size_t k = j; k < n; ++k) largest = std::max(largest, std::fabs(graph.constant_value(matrix[i][k]).value_or(0)));
    return std::fabs(graph.constant_value(matrix[i][j]).value_or(0)) / largest;
  };
  auto const better = [&](std::size_t i, std::size_t than, std::size_t j) {
    int const rank = pivot_rank(graph, matrix[i][j]), other = pivot_rank(graph, matrix[than][j]);
    if (rank != other) return rank < other;
    return rank == 0 && share(i, j) > share(than, j);
  };
  for (std::size_t j = 0; j < n; ++j) {
    std::size_t best = n;
    for (std::size_t i = 0; i < n; ++i) {
      if (used[i] || graph.is_constant(matrix[i][j], 0)) continue;
      if (best == n || better(i, best, j)) best = i;
    }
    if (best == n) return ReductionFailure{ReductionFailure::Kind::singular, 0, static_cast<int>(j)};
    used[best] = true;
    row_of[j] = best;
    for (std::size_t i = 0; i < n; ++i) {
      if (used[i] || graph.is_constant(matrix[i][j], 0)) continue;
      NodeId const factor = graph.divide(matrix[i][j], matrix[best][j]);
      matrix[i][j] = zero;
      for (std::size_t k = j + 1; k < n; ++k) matrix[i][k] = graph.subtract(matrix[i][k], graph.multiply(factor, matrix[best][k]));
      right[i] = graph.subtract(right[i], graph.multiply(factor, right[best]));
    }
  }
  std::vector<NodeId> solution(n, zero);
  for (std::size_t j = n; j-- > 0;) {
    std::size_t const i = row_of[j];
    NodeId sum = right[i];
    for (std::size_t k = j + 1; k < n; ++k) sum = graph.subtract(sum, graph.multiply(matrix[i][k], solution[k]));
    solution[j] = graph.divide(sum, matrix[i][j]);
  }
  return solution;
}

}  // namespace sysid
