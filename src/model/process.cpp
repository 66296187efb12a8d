// The parametric part of expressions.
#include "model/process.hpp"

namespace sysid {

std::vector<NodeId> read_by(std::vector<Process> const& processes) {
  std::vector<NodeId> roots;
  for (Process const& process : processes) {
    roots.insert(roots.end(), process.arguments.begin(), process.arguments.end());
    for (KernelUse const& kernel : process.kernels)
      roots.insert(roots.end(), kernel.hyper_parameters.begin(), kernel.hyper_parameters.end());
  }
  return roots;
}

NodeId without_processes(Graph& graph, NodeId root) {
  return graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
    return graph[leaf].leaf_kind == LeafKind::process ? std::optional(graph.constant(0)) : std::nullopt;
  });
}

}  // namespace sysid
