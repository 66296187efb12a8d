// Differentiated symbolically, once.
#include "model/state_jacobian.hpp"

namespace sysid {

std::vector<NodeId> state_jacobian(Graph& graph, Model const& model) {
  std::vector<NodeId> slopes;
  for (State const& of : model.states)
    for (std::size_t j = 0; j < model.states.size(); ++j)
      slopes.push_back(graph.differentiate(of.derivative, graph.leaf(LeafKind::state, static_cast<int>(j))));
  return slopes;
}

StateJacobian::StateJacobian(Model const& model)
    : graph_(model.graph), slopes_(state_jacobian(graph_, model)), states_(static_cast<Eigen::Index>(model.states.size())) {}

Eigen::MatrixXd StateJacobian::at(std::function<double(Node const& leaf)> const& value_of) const {
  std::vector<double> const slopes = graph_.evaluate(slopes_, [&](NodeId leaf) { return value_of(graph_[leaf]); });
  Eigen::MatrixXd result(states_, states_);
  for (Eigen::Index i = 0; i < states_; ++i)
    for (Eigen::Index j = 0; j < states_; ++j) result(i, j) = slopes[static_cast<std::size_t>(i * states_ + j)];
  return result;
}

}  // namespace sysid
