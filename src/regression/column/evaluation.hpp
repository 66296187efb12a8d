// Expressions over whole columns of numbers: what every way to project a dictionary starts from.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <span>

#include "expression/graph.hpp"

namespace sysid::regression {

/// Numbers of a leaf at `count` points.
using LeafColumn = std::function<std::span<double const>(NodeId leaf)>;

/// roots at `count` points: [count x roots]. Bit for bit what Graph::evaluate gives at each.
Eigen::MatrixXd evaluate_columns(Graph const& graph, std::span<NodeId const> roots, LeafColumn const& leaf, int count);

}  // namespace sysid::regression
