// An explicit one-step method as a row: it writes one step of size h as expressions, and the program stage compiles them like any
// other. One file and one row (integrator.cpp) adds another.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "expression/graph.hpp"

namespace sysid {

/// The derivative at one stage: `states` replace the state leaves, inputs and time are read at `stage`.
struct Stages {
  Graph& graph;
  std::span<NodeId const> derivative;
  std::vector<NodeId> states;  // leaves at the beginning of the step
  NodeId h;

  std::vector<NodeId> evaluate(std::span<NodeId const> at, Stage stage) const;
};

struct IntegratorRow {
  std::string_view name;
  int order;
  /// The states after one step.
  std::vector<NodeId> (*step)(Stages const&);
  std::string_view summary;
};

std::span<IntegratorRow const> integrators();
/// nullptr when there is none of that name.
IntegratorRow const* find_integrator(std::string_view name);

}  // namespace sysid
