// Symbolic Jacobian of the first-order system, and both as kernels with one layout of inputs.
#include "program/equation_kernels.hpp"

#include "program/simulation_program.hpp"

namespace sysid {

EquationKernels compile_equation_kernels(SimulationSource const& source) {
  Graph graph = source.graph;
  EquationKernels result;
  result.parameters = source.parameters;
  result.states = source.states();
  std::vector<NodeId> rates = source.derivative, leaves;
  rates.insert(rates.end(), source.constraints.begin(), source.constraints.end());
  for (int p = 0; p < result.parameters; ++p) leaves.push_back(graph.leaf(LeafKind::parameter, p));
  for (int s = 0; s < result.states; ++s) leaves.push_back(graph.leaf(LeafKind::state, s));
  for (NodeId const id : graph.reachable(rates)) {
    Node const& node = graph[id];
    if (node.operation != Operation::leaf) continue;
    if (node.leaf_kind == LeafKind::parameter || node.leaf_kind == LeafKind::state) continue;
    result.data.push_back({node.leaf_kind, node.index, node.stage});
    leaves.push_back(id);
  }
  std::vector<NodeId> jacobian;
  for (int s = 0; s < result.states; ++s)
    for (NodeId const rate : rates) jacobian.push_back(graph.differentiate(rate, graph.leaf(LeafKind::state, s)));
  result.rates = compile_kernel(graph, leaves, rates);
  result.jacobian = compile_kernel(graph, leaves, jacobian);
  return result;
}

}  // namespace sysid
