// The Jacobian of a model's derivatives by its states: as expressions, and in numbers.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "model/model.hpp"

namespace sysid {

/// Row by row, in `graph`, which is the model's and grows. InternalError for a function without a derivative.
std::vector<NodeId> state_jacobian(Graph& graph, Model const& model);

class StateJacobian {
 public:
  explicit StateJacobian(Model const& model);

  /// [states x states]. value_of: a leaf.
  Eigen::MatrixXd at(std::function<double(Node const& leaf)> const& value_of) const;

 private:
  Graph graph_;
  std::vector<NodeId> slopes_;
  Eigen::Index states_;
};

}  // namespace sysid
