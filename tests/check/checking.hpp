// Texts to checked models, and numbers out of their expressions.
#pragma once
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <string>

#include "load/load.hpp"
#include "relative.hpp"

namespace sysid::test {

/// What the front end says; empty when there is nothing to say.
inline std::string messages(std::string const& text) {
  Source source("test.sysid", text);
  Diagnostics diagnostics;
  load(source, diagnostics);
  return render(diagnostics, source);
}

inline CheckedFile checked(std::string const& text) {
  Source source("test.sysid", text);
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  REQUIRE_MESSAGE(file.has_value(), render(diagnostics, source));
  return std::move(*file);
}

/// The only model of a file that holds these statements.
inline Model model_of(std::string const& statements) { return checked("model m {\n" + statements + "\n}\n").models.at(0); }

/// Values of leaves in SI by their names: states "y" and "y'", inputs "x", their rates "x'", parameters, white noise "noise(w)",
/// time "t".
using Values = std::map<std::string, double>;

inline double at(Model const& model, NodeId node, Values const& values) {
  return model.graph.evaluate(node, [&](NodeId id) {
    Node const& leaf = model.graph[id];
    auto const index = static_cast<std::size_t>(leaf.index);
    switch (leaf.leaf_kind) {
      case LeafKind::state:
        return values.at(model.states[index].name);
      case LeafKind::input:
        return values.at(model.inputs[index].name);
      case LeafKind::input_rate:
        return values.at(model.inputs[index].name + "'");
      case LeafKind::parameter:
        return values.at(model.parameters[index].name);
      case LeafKind::disturbance:
        return values.at("noise(" + model.disturbances[index].name + ")");
      default:
        return values.at("t");
    }
  });
}

/// The time derivative of a component of the first-order system.
inline double rate_of(Model const& model, std::string const& state, Values const& values) {
  for (State const& each : model.states)
    if (each.name == state) return at(model, each.derivative, values);
  FAIL("no state " << state);
  return 0;
}

inline double initial_of(Model const& model, std::string const& state, Values const& values = {}) {
  for (State const& each : model.states)
    if (each.name == state) return at(model, each.initial, values);
  FAIL("no state " << state);
  return 0;
}

inline std::size_t errors_in(std::string const& shown) {
  std::size_t n = 0;
  for (std::size_t place = shown.find("error["); place != std::string::npos; place = shown.find("error[", place + 1)) ++n;
  return n;
}

inline doctest::Approx near(double value) { return relative(value, 1e-14); }

}  // namespace sysid::test
