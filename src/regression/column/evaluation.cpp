// Node by node over short blocks of points, so that a long record needs no memory per node.
#include "regression/column/evaluation.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <vector>

#include "expression/function.hpp"

namespace sysid::regression {
namespace {

/// `apply` to each of `count` values. Functions over lanes have the bits of those of one number, and take a fraction of the time.
void apply_all(Node const& node, double const* a, double const* b, double const* c, double* result, int count) {
  if (node.operation == Operation::power) return elementary::pow_lanes(a, b, result, count);
  if (node.operation == Operation::call) {
    Function const& function = *node.function;
    return function.arity == 1 ? function.unary_lanes(a, result, count) : function.binary_lanes(a, b, result, count);
  }
  for (int k = 0; k < count; ++k) result[k] = apply(node, a[k], b[k], c[k]);
}

}  // namespace

Eigen::MatrixXd evaluate_columns(Graph const& graph, std::span<NodeId const> roots, LeafColumn const& leaf, int count) {
  constexpr int block = 256;
  std::vector<NodeId> const order = graph.reachable(roots);
  std::unordered_map<NodeId, int> place;
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<int>(i);
  std::vector<std::array<int, 3>> operands(order.size());
  std::vector<std::span<double const>> columns(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    Node const& node = graph[order[i]];
    NodeId const ids[] = {node.a, node.b, node.c};
    for (int k = 0; k < graph.operand_count(order[i]); ++k) operands[i][static_cast<std::size_t>(k)] = place.at(ids[k]);
    if (node.operation == Operation::leaf) columns[i] = leaf(order[i]);
  }
  Eigen::MatrixXd out(count, static_cast<Eigen::Index>(roots.size()));
  Eigen::MatrixXd values(block, static_cast<Eigen::Index>(order.size()));
  for (int first = 0; first < count; first += block) {
    int const width = std::min(block, count - first);
    for (std::size_t i = 0; i < order.size(); ++i) {
      Node const& node = graph[order[i]];
      double* const result = values.col(static_cast<Eigen::Index>(i)).data();
      if (node.operation == Operation::constant) {
        std::fill_n(result, width, node.value);
      } else if (node.operation == Operation::leaf) {
        std::copy_n(columns[i].data() + first, width, result);
      } else {
        double const* const a = values.col(operands[i][0]).data();
        double const* const b = values.col(operands[i][1]).data();
        double const* const c = values.col(operands[i][2]).data();
        apply_all(node, a, b, c, result, width);
      }
    }
    for (std::size_t r = 0; r < roots.size(); ++r)
      out.col(static_cast<Eigen::Index>(r)).segment(first, width) = values.col(place.at(roots[r])).head(width);
  }
  return out;
}

Eigen::MatrixXd rows_at(Eigen::MatrixXd const& all, std::vector<int> const& rows) {
  Eigen::MatrixXd kept(static_cast<Eigen::Index>(rows.size()), all.cols());
  for (std::size_t r = 0; r < rows.size(); ++r) kept.row(static_cast<Eigen::Index>(r)) = all.row(rows[r]);
  return kept;
}

Columns stacked(std::vector<Eigen::MatrixXd> const& blocks, std::size_t terms) {
  Eigen::Index count = 0, first = 0;
  for (Eigen::MatrixXd const& part : blocks) count += part.rows();
  Columns columns{Eigen::VectorXd(count), Eigen::MatrixXd(count, static_cast<Eigen::Index>(terms))};
  for (Eigen::MatrixXd const& part : blocks) {
    columns.known.segment(first, part.rows()) = part.col(0);
    columns.terms.middleRows(first, part.rows()) = part.rightCols(part.cols() - 1);
    first += part.rows();
  }
  return columns;
}

}  // namespace sysid::regression
