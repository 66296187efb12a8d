// Expressions over whole columns of numbers: what every way to project a dictionary starts from.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "expression/graph.hpp"
#include "regression/column/columns.hpp"

namespace sysid::regression {

/// Numbers of a leaf at `count` points.
using LeafColumn = std::function<std::span<double const>(NodeId leaf)>;

/// roots at `count` points: [count x roots]. Bit for bit what Graph::evaluate gives at each.
Eigen::MatrixXd evaluate_columns(Graph const& graph, std::span<NodeId const> roots, LeafColumn const& leaf, int count);

/// The rows of these numbers.
Eigen::MatrixXd rows_at(Eigen::MatrixXd const& all, std::vector<int> const& rows);

/// Blocks of rows, one for each experiment, the known side before the terms.
Columns stacked(std::vector<Eigen::MatrixXd> const& blocks, std::size_t terms);

}  // namespace sysid::regression
