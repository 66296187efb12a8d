// Degrees from the leaves up: 0 constant, 1 affine, 2 more than that.
#include "expression/affine.hpp"

#include <algorithm>
#include <vector>

namespace sysid {
namespace {

int degree_of(Node const& node, int a, int b, int c) {
  switch (node.operation) {
    case Operation::negate:
    case Operation::add:
    case Operation::subtract:
      return std::max(a, b);
    case Operation::multiply:
      return a + b;
    case Operation::fused:
      return std::max(a + b, c);
    case Operation::divide:
      return b > 0 ? 2 : a;
    case Operation::select:
      return a > 0 ? 2 : std::max(b, c);
    default:
      return a + b + c > 0 ? 2 : 0;
  }
}

}  // namespace

std::optional<NodeId> find_not_affine(Graph const& graph, std::span<NodeId const> roots,
                                      std::function<bool(Node const&)> const& varies) {
  std::vector<NodeId> const order = graph.reachable(roots);
  std::vector<int> degree(order.empty() ? 0 : order.back() + std::size_t{1}, 0);
  for (NodeId const id : order) {
    Node const& node = graph[id];
    if (node.operation == Operation::leaf) {
      degree[id] = varies(node) ? 1 : 0;
      continue;
    }
    int const operands = operand_count(node);
    degree[id] =
        degree_of(node, operands > 0 ? degree[node.a] : 0, operands > 1 ? degree[node.b] : 0, operands > 2 ? degree[node.c] : 0);
    if (degree[id] > 1) return id;
  }
  return std::nullopt;
}

}  // namespace sysid
