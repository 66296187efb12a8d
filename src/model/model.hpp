// The checked model: typed, first order, no text left but names and spans. Everything numeric is in coherent SI units.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/unit.hpp"
#include "distribution/distribution.hpp"
#include "expression/graph.hpp"

namespace sysid {

/// A declared thing: the user's name, unit (absent: undeclared) and where it stands.
struct Quantity {
  std::string name;
  std::optional<Unit> unit;
  Span span;

  /// Declared number -> SI and back; offsets never enter equations.
  double to_si(double declared) const { return unit ? declared * unit->scale : declared; }
  double from_si(double si) const { return unit ? si / unit->scale : si; }
  std::string unit_text() const { return unit ? unit->text : std::string(); }
};

/// One component of the first-order system: leaf state(i).
struct State : Quantity {  // named "y", "y'", "y''", ...
  NodeId derivative = 0;   // expression in state, input, parameter, time leaves
  NodeId initial = 0;      // expression in parameters only
  bool initial_given = false;
};

/// Leaf parameter(i). Sampled when it has a prior, else fixed at `value`. `per_experiment`: every experiment has its own; a data
/// block may fix it there, must where there is neither prior nor value.
struct Parameter : Quantity {
  bool per_experiment = false;
  std::optional<Distribution> prior;  // arguments and bounds are SI expressions of constants and other parameters
  std::optional<NodeId> value;        // a constant expression
};

/// What is measured: leaf measured(i) is its sample.
struct Channel : Quantity {
  Distribution noise;
};

/// A quantity of interest. Per sample when it reads states, inputs or time.
struct Derived : Quantity {
  NodeId value = 0;
  bool per_sample = false;
};

/// Something whose unit could not be compared with others: a name that declares none, or an expression.
struct Unchecked {
  std::string what;  // as written
  Span span;
  std::string why;
};

struct Model {
  std::string name;
  std::string title;
  Graph graph;
  std::vector<Quantity> inputs;
  std::vector<State> states;
  std::vector<Parameter> parameters;  // in the user's order
  std::vector<int> sampling_order;    // sampled parameters, each after those its prior refers to
  std::vector<Channel> channels;
  std::vector<Derived> derived;
  std::vector<Unchecked> unchecked;  // in the order of the text
};

}  // namespace sysid
