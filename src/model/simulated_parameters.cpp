// Reachability from what a simulation computes.
#include "model/simulated_parameters.hpp"

#include <algorithm>

namespace sysid {

namespace {

/// Parameters below the roots, and those below the values and priors of parameters that are.
std::vector<bool> parameters_below(Model const& model, Graph const& graph, std::vector<NodeId> const& roots) {
  std::vector<bool> read(model.parameters.size());
  std::vector<int> fresh;
  auto const look = [&](std::vector<NodeId> const& below) {
    for (NodeId const id : graph.reachable(below)) {
      Node const& node = graph[id];
      auto const p = static_cast<std::size_t>(node.index);
      if (node.operation != Operation::leaf || node.leaf_kind != LeafKind::parameter || read[p]) continue;
      read[p] = true;
      fresh.push_back(node.index);
    }
  };
  look(roots);
  while (!fresh.empty()) {
    Parameter const& parameter = model.parameters[static_cast<std::size_t>(fresh.back())];
    fresh.pop_back();
    std::vector<NodeId> below;
    if (parameter.value) below.push_back(*parameter.value);
    if (parameter.prior) {
      below.insert(below.end(), parameter.prior->arguments.begin(), parameter.prior->arguments.end());
      for (auto const& bound : {parameter.prior->lower, parameter.prior->upper})
        if (bound) below.push_back(*bound);
    }
    look(below);
  }
  return read;
}

}  // namespace

std::vector<bool> simulated_parameters(Model const& model) {
  Graph graph = model.graph;
  std::vector<NodeId> roots = read_by(model.processes);
  for (State const& state : model.states) roots.insert(roots.end(), {state.derivative, state.initial});
  for (State const& state : model.states)
    if (state.initial_variance) roots.push_back(*state.initial_variance);
  for (Disturbance const& disturbance : model.disturbances) roots.push_back(disturbance.intensity);
  roots.insert(roots.end(), model.memories.begin(), model.memories.end());
  roots.insert(roots.end(), model.residuals.begin(), model.residuals.end());
  for (Unknown const& unknown : model.unknowns) roots.push_back(unknown.guess);
  for (Channel const& channel : model.channels) roots.push_back(channel.noise.row->centre(graph, channel.noise.arguments));
  return parameters_below(model, graph, roots);
}

std::vector<bool> measured_parameters(Model const& model) {
  std::vector<bool> all = simulated_parameters(model);
  std::vector<NodeId> noise;
  for (Channel const& channel : model.channels) {
    noise.insert(noise.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
    for (auto const& bound : {channel.noise.lower, channel.noise.upper})
      if (bound) noise.push_back(*bound);
  }
  std::vector<bool> const by_noise = parameters_below(model, model.graph, noise);
  for (std::size_t p = 0; p < all.size(); ++p) all[p] = all[p] || by_noise[p];
  return all;
}

std::vector<std::string> derived_from_noise(Model const& model) {
  std::vector<bool> const simulated = simulated_parameters(model);
  std::vector<std::string> names;
  for (Derived const& derived : model.derived) {
    std::vector<bool> const read = parameters_below(model, model.graph, {derived.value});
    for (std::size_t p = 0; p < read.size(); ++p)
      if (read[p] && !simulated[p] && model.parameters[p].prior) {
        names.push_back(derived.name);
        break;
      }
  }
  return names;
}

Model without_noise_parameters(Model model) {
  std::vector<bool> const read = simulated_parameters(model);
  for (std::size_t p = 0; p < read.size(); ++p) {
    Parameter& parameter = model.parameters[p];
    if (read[p] || !parameter.prior) continue;
    parameter.prior.reset();
    parameter.per_experiment = false;
    parameter.value = model.graph.constant(1);
  }
  std::erase_if(model.sampling_order, [&](int p) { return !model.parameters[static_cast<std::size_t>(p)].prior; });
  return model;
}

}  // namespace sysid
