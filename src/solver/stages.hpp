// What an explicit one-step method with fixed steps writes one step of size h with, as expressions; the program stage compiles them
// like any other. One file and one row (solver.cpp) adds a method.
#pragma once
#include <span>
#include <vector>

#include "expression/graph.hpp"

namespace sysid {

/// Where a method evaluated the derivative, for a diagnosis of failed solves.
struct StageVisit {
  std::vector<NodeId> states;
  Stage stage = Stage::begin;
};

/// What a method writes its step with.
struct Stages {
  Graph& graph;
  std::span<NodeId const> derivative;
  std::vector<NodeId> states;  // leaves: the states at the beginning of the step
  NodeId h;                    // leaf: the step size
  std::vector<StageVisit>& visited;

  /// The derivative where `at` replaces the states, inputs and time being read at `stage`.
  std::vector<NodeId> evaluate(std::span<NodeId const> at, Stage stage) const;
  /// states + by * slopes
  std::vector<NodeId> advance(std::span<NodeId const> slopes, NodeId by) const;
};

}  // namespace sysid
