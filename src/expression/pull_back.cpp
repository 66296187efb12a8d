// From users to operands, each node once: a node comes behind its operands, so the order of numbers, backwards, will do.
#include "expression/pull_back.hpp"

#include <algorithm>
#include <ranges>

#include "expression/finite_slope.hpp"
#include "expression/function.hpp"

namespace sysid {

bool knows_derivatives(Graph const& graph, std::span<NodeId const> roots) {
  return std::ranges::all_of(graph.reachable(roots), [&](NodeId id) {
    return graph[id].operation != Operation::call || graph[id].function->derivative != nullptr;
  });
}

std::vector<NodeId> pull_back(Graph& graph, std::span<NodeId const> roots, std::span<NodeId const> weights,
                              std::span<NodeId const> leaves) {
  std::vector<NodeId> const order = graph.reachable(roots);
  NodeId const zero = graph.constant(0);
  std::size_t size = 0;
  for (NodeId const id : order) size = std::max(size, id + std::size_t{1});
  for (NodeId const leaf : leaves) size = std::max(size, leaf + std::size_t{1});
  std::vector<bool> moves(size), ends(size);  // with one of the leaves; at one
  for (NodeId const leaf : leaves) moves[leaf] = ends[leaf] = true;
  for (NodeId const id : order) {
    Node const& node = graph[id];
    NodeId const operands[] = {node.a, node.b, node.c};
    for (int i = 0; i < operand_count(node); ++i) moves[id] = moves[id] || moves[operands[i]];
  }
  std::vector<NodeId> adjoint(size, zero);
  for (std::size_t i = 0; i < roots.size(); ++i)
    if (moves[roots[i]]) adjoint[roots[i]] = graph.add(adjoint[roots[i]], weights[i]);
  for (NodeId const id : order | std::views::reverse) {
    Node const node = graph[id];  // a copy: the graph grows below
    NodeId const weight = adjoint[id], operands[] = {node.a, node.b, node.c};
    if (graph.is_constant(weight, 0) || ends[id]) continue;
    for (int i = 0; i < operand_count(node); ++i) {
      if (!moves[operands[i]]) continue;
      // (a/b)' by b is -(w/b) (a/b), which shares w/b with that by a.
      NodeId const change = node.operation == Operation::divide && i == 1
                                ? graph.negate(graph.multiply(graph.divide(weight, node.b), id))
                                : finite_change(graph, id, i == 0 ? weight : zero, i == 1 ? weight : zero, i == 2 ? weight : zero);
      adjoint[operands[i]] = graph.add(adjoint[operands[i]], change);
    }
  }
  std::vector<NodeId> result;
  for (NodeId const leaf : leaves) result.push_back(adjoint[leaf]);
  return result;
}

}  // namespace sysid
