// Models with random states for the tests of particles: written in the language with an input in the place of each disturbance.
#pragma once
#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "likelihood/particle/particle_target.hpp"
#include "load/load.hpp"

namespace sysid::testing {

inline Model parsed_model(std::string const& text) {
  Source source("case.sysid", text);
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  return file->models.front();
}

inline NodeId parameter_named(Model& model, std::string const& name) {
  for (std::size_t p = 0; p < model.parameters.size(); ++p)
    if (model.parameters[p].name == name) return model.graph.leaf(LeafKind::parameter, static_cast<int>(p));
  FAIL("no parameter " << name);
  return 0;
}

/// The last input becomes what `replacement` says, wherever it stands.
inline void replace_last_input(Model& model, NodeId replacement) {
  int const input = static_cast<int>(model.inputs.size()) - 1;
  auto const replace = [&](NodeId& root) {
    root = model.graph.substitute(root, [&](NodeId id) -> std::optional<NodeId> {
      Node const& node = model.graph[id];
      return node.leaf_kind == LeafKind::input && node.index == input ? std::optional(replacement) : std::nullopt;
    });
  };
  for (State& state : model.states) replace(state.derivative);
  for (Derived& each : model.derived) replace(each.value);
  for (LaggedQuantity& each : model.lagged_quantities) replace(each.present);
  for (Channel& channel : model.channels)
    for (NodeId& argument : channel.noise.arguments) replace(argument);
  model.inputs.pop_back();
}

inline NodeId squared_parameter(Model& model, std::string const& name) {
  NodeId const size = parameter_named(model, name);
  return model.graph.multiply(size, size);
}

/// The last input becomes a disturbance whose intensity is the square of a parameter; in discrete time a state that is one.
inline void disturb(Model& model, std::string const& sd, bool held = false) {
  Disturbance made;
  made.name = model.inputs.back().name;
  made.intensity = squared_parameter(model, sd);
  made.held = held;
  NodeId const leaf = model.graph.leaf(LeafKind::disturbance, static_cast<int>(model.disturbances.size()));
  if (model.dynamics == Dynamics::discrete) {
    made.state = static_cast<int>(model.states.size());
    replace_last_input(model, model.graph.leaf(LeafKind::state, made.state));
    State state;
    state.name = made.name;
    state.derivative = leaf;
    state.initial = model.graph.constant(0);
    state.initial_variance = made.intensity;
    model.states.push_back(state);
  } else {
    replace_last_input(model, leaf);
  }
  model.disturbances.push_back(made);
}

inline void random_start(Model& model, int state, std::string const& sd) {
  model.states[static_cast<std::size_t>(state)].initial_variance = squared_parameter(model, sd);
}

inline std::unique_ptr<ParticleTarget> particle_target(Model const& model, std::vector<Experiment> experiments, int particles,
                                                       SolverSettings const& solver = {}, ExecutionOptions execution = {}) {
  std::vector<ExperimentMember> members;
  for (Experiment const& each : experiments) members.push_back({each.name, {}});
  TargetOptions options;
  options.solver = solver;
  options.execution = execution;
  ParticleOptions chosen;
  chosen.particles = particles;
  return std::make_unique<ParticleTarget>(particle_model(model, solver.method),
                                          std::make_shared<ParameterSpace const>(model, members), std::move(experiments), options,
                                          chosen);
}

/// theta of declared values, the same in all lanes.
inline LaneArray lanes_of(Target const& target, std::vector<double> const& values, int width) {
  LaneArray declared(target.dimension(), width), theta(target.dimension(), width);
  for (int p = 0; p < declared.rows(); ++p)
    for (int w = 0; w < width; ++w) declared(p, w) = values[static_cast<std::size_t>(p)];
  target.unconstrain(declared, theta);
  return theta;
}

/// How many standard errors the mean of `repeats` independent estimates of the likelihood lies from exp(exact).
struct Bias {
  double z, relative_sd;
};
inline Bias bias(ParticleTarget const& target, std::vector<double> const& values, double exact, int repeats, std::uint64_t seed) {
  std::vector<double> out(static_cast<std::size_t>(repeats));
  Ledger ledger;
  target.estimate(lanes_of(target, values, repeats), {.seed = seed}, out, ledger);
  double sum = 0, squares = 0;
  for (double& value : out) {
    value = std::exp(value - exact);
    sum += value;
  }
  double const mean = sum / repeats;
  for (double const value : out) squares += (value - mean) * (value - mean);
  double const sd = std::sqrt(squares / (repeats - 1));
  return {(mean - 1) / (sd / std::sqrt(repeats)), sd};
}

}  // namespace sysid::testing
