// Targets with free coefficients, taken apart into a known side and terms that are always in.
#include "regression/column/dictionary.hpp"

namespace sysid::regression {

std::optional<SplitTarget> split_target(Graph& graph, NodeId target, std::span<std::pair<std::string, NodeId> const> coefficients) {
  auto const is_coefficient = [&](NodeId id) {
    for (auto const& [name, leaf] : coefficients)
      if (leaf == id) return true;
    return false;
  };
  auto const free_of_coefficients = [&](NodeId root) {
    for (NodeId const id : graph.reachable({&root, 1}))
      if (is_coefficient(id)) return false;
    return true;
  };
  SplitTarget split;
  for (auto const& [name, leaf] : coefficients) {
    NodeId const factor = graph.differentiate(target, leaf);
    if (graph.is_constant(factor, 0) || !free_of_coefficients(factor)) return std::nullopt;
    split.free.push_back({name, graph.negate(factor), true});
  }
  NodeId const zero = graph.constant(0);
  split.known = graph.substitute(
      target, [&](NodeId id) -> std::optional<NodeId> { return is_coefficient(id) ? std::optional(zero) : std::nullopt; });
  return split;
}

}  // namespace sysid::regression
