// The table of explicit one-step methods, and what they share.
#include "program/integrator.hpp"

#include "core/setting/table.hpp"

namespace sysid {

std::vector<NodeId> rk4_step(Stages const& stages);    // rk4.cpp
std::vector<NodeId> heun_step(Stages const& stages);   // heun.cpp
std::vector<NodeId> euler_step(Stages const& stages);  // euler.cpp

std::span<IntegratorRow const> integrators() {
  static constexpr IntegratorRow rows[] = {
      {"rk4", 4, &rk4_step, "the classical Runge-Kutta method, four evaluations a step"},
      {"heun", 2, &heun_step, "Heun's method (explicit trapezoidal rule), two evaluations a step"},
      {"euler", 1, &euler_step, "Euler's explicit method, one evaluation a step"},
  };
  return rows;
}

IntegratorRow const* find_integrator(std::string_view name) { return row_named(integrators(), name); }

std::vector<NodeId> Stages::evaluate(std::span<NodeId const> at, Stage stage) const {
  visited.push_back({{at.begin(), at.end()}, stage});
  return graph.substitute(derivative, [&](NodeId id) -> std::optional<NodeId> {
    Node const leaf = graph[id];
    switch (leaf.leaf_kind) {
      case LeafKind::state:
        return at[static_cast<std::size_t>(leaf.index)];
      case LeafKind::input:
      case LeafKind::input_rate:
      case LeafKind::time:
        return graph.leaf(leaf.leaf_kind, leaf.index, stage, leaf.lag);
      default:
        return std::nullopt;
    }
  });
}

std::vector<NodeId> Stages::advance(std::span<NodeId const> slopes, NodeId by) const {
  std::vector<NodeId> result;
  for (std::size_t i = 0; i < slopes.size(); ++i) result.push_back(graph.add(states[i], graph.multiply(by, slopes[i])));
  return result;
}

}  // namespace sysid
