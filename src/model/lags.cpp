// Registers for lagged values, and the substitutions between data and model that prediction rules are.
#include "model/lags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace sysid {
namespace {

using Replacement = std::function<std::optional<NodeId>(NodeId)>;

void replace(Graph& graph, NodeId& root, Replacement const& replacement) { root = graph.substitute(root, replacement); }

/// All expressions of a model but initial values and priors.
template <class Visit>
void each_root(Model& model, Visit const& visit) {
  for (State& state : model.states) visit(state.derivative);
  for (Channel& channel : model.channels)
    for (NodeId& argument : channel.noise.arguments) visit(argument);
  for (Derived& derived : model.derived) visit(derived.value);
  for (LaggedQuantity& lagged : model.lagged_quantities) visit(lagged.present);
  for (Process& process : model.processes)
    for (NodeId& argument : process.arguments) visit(argument);
  for (Expansion& expansion : model.expansions)
    for (std::vector<NodeId>& application : expansion.applications)
      for (NodeId& argument : application) visit(argument);
}

bool is_leaf(Node const& node, LeafKind kind) { return node.operation == Operation::leaf && node.leaf_kind == kind; }

NodeId at_lag(Graph& graph, NodeId root, int lag) {
  return graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
    Node const node = graph[leaf];
    if (node.leaf_kind != LeafKind::measured) return std::nullopt;
    return graph.leaf(node.leaf_kind, node.index, node.stage, node.lag + lag);
  });
}

NodeId register_leaf(Model& model, LaggedQuantity const& lagged, int lag) {
  return model.graph.leaf(LeafKind::state, lagged.registers[static_cast<std::size_t>(lag - 1)]);
}

/// Lags of `past` up to `lags` exist afterwards; new ones begin with `initial`, an expression at their own sample.
void add_registers(Model& model, std::size_t lagged, int lags, NodeId initial) {
  LaggedQuantity& what = model.lagged_quantities[lagged];
  while (static_cast<int>(what.registers.size()) < lags) {
    int const lag = static_cast<int>(what.registers.size()) + 1;
    State state;
    state.name = fmt::format("lag({}, {})", what.channel < 0 ? what.name : fmt::format("predicted({})", what.name), lag);
    state.unit = what.unit;
    state.span = what.span;
    state.derivative = lag == 1 ? what.present : register_leaf(model, what, lag - 1);
    state.initial = at_lag(model.graph, initial, lag);
    state.initial_given = true;
    what.registers.push_back(static_cast<int>(model.states.size()));
    model.states.push_back(std::move(state));
  }
}

NodeId measured_leaf(Model& model, int channel) { return model.graph.leaf(LeafKind::measured, channel); }

/// The channel that measures a past: its own, or one that is centred on it.
std::optional<int> channel_of(Model& model, LaggedQuantity const& lagged) {
  if (lagged.channel >= 0) return lagged.channel;
  for (std::size_t c = 0; c < model.channels.size(); ++c)
    if (model.channels[c].noise.row->centre(model.graph, model.channels[c].noise.arguments) == lagged.present)
      return static_cast<int>(c);
  return std::nullopt;
}

/// Keeps the states that channels, derived quantities or states that are kept read.
void drop_unread_states(Model& model) {
  std::vector<NodeId> roots;
  for (Channel const& channel : model.channels)
    roots.insert(roots.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
  for (Derived const& derived : model.derived) roots.push_back(derived.value);
  for (Process const& process : model.processes) roots.insert(roots.end(), process.arguments.begin(), process.arguments.end());
  for (Expansion const& expansion : model.expansions)
    for (std::vector<NodeId> const& application : expansion.applications)
      roots.insert(roots.end(), application.begin(), application.end());
  std::set<int> kept;
  while (true) {
    std::size_t const before = kept.size();
    for (NodeId const id : model.graph.reachable(roots))
      if (is_leaf(model.graph[id], LeafKind::state) && kept.insert(model.graph[id].index).second)
        roots.push_back(model.states[static_cast<std::size_t>(model.graph[id].index)].derivative);
    if (kept.size() == before) break;
  }
  std::map<int, int> renumbered;
  std::vector<State> states;
  for (int const index : kept) {
    renumbered.emplace(index, static_cast<int>(states.size()));
    states.push_back(std::move(model.states[static_cast<std::size_t>(index)]));
  }
  model.states = std::move(states);
  // A disturbance in discrete time is a state, which nothing else reads the leaf of.
  std::map<int, int> leaves;
  std::vector<Disturbance> disturbances;
  for (std::size_t i = 0; i < model.disturbances.size(); ++i) {
    if (!renumbered.contains(model.disturbances[i].state)) continue;
    leaves.emplace(static_cast<int>(i), static_cast<int>(disturbances.size()));
    disturbances.push_back(std::move(model.disturbances[i]));
    disturbances.back().state = renumbered.at(disturbances.back().state);
  }
  model.disturbances = std::move(disturbances);
  // Each register reads the one before it, so what stays of a past are its first ones, in order.
  for (LaggedQuantity& lagged : model.lagged_quantities) {
    std::vector<int> registers;
    for (int const index : lagged.registers)
      if (renumbered.contains(index)) registers.push_back(renumbered.at(index));
    lagged.registers = std::move(registers);
  }
  auto const renumber = [&](NodeId leaf) -> std::optional<NodeId> {
    Node const node = model.graph[leaf];
    if (node.leaf_kind == LeafKind::disturbance && leaves.contains(node.index))
      return model.graph.leaf(LeafKind::disturbance, leaves.at(node.index));
    if (node.leaf_kind != LeafKind::state || !renumbered.contains(node.index)) return std::nullopt;
    return model.graph.leaf(LeafKind::state, renumbered.at(node.index));
  };
  each_root(model, [&](NodeId& root) { replace(model.graph, root, renumber); });
}

void free_run(Model& model) {
  std::map<int, int> most;  // lags of each channel's samples
  each_root(model, [&](NodeId root) {
    for (NodeId const id : model.graph.reachable({&root, 1}))
      if (is_leaf(model.graph[id], LeafKind::measured))
        most[model.graph[id].index] = std::max(most[model.graph[id].index], model.graph[id].lag);
  });
  std::map<int, std::size_t> lagged_of;
  for (auto const& each : most) {
    int const channel = each.first;
    auto const found = std::find_if(model.lagged_quantities.begin(), model.lagged_quantities.end(),
                                    [&](LaggedQuantity const& lagged) { return lagged.channel == channel; });
    lagged_of[channel] = static_cast<std::size_t>(found - model.lagged_quantities.begin());
    add_registers(model, lagged_of[channel], each.second, measured_leaf(model, channel));
  }
  // A present sample of another channel is what the model predicts for it, which may read a further one.
  auto const predicted = [&](NodeId leaf) -> std::optional<NodeId> {
    Node const node = model.graph[leaf];
    if (node.leaf_kind != LeafKind::measured) return std::nullopt;
    LaggedQuantity const& lagged = model.lagged_quantities[lagged_of.at(node.index)];
    return node.lag == 0 ? lagged.present : register_leaf(model, lagged, node.lag);
  };
  for (std::size_t i = 0; i <= model.channels.size(); ++i)
    each_root(model, [&](NodeId& root) { replace(model.graph, root, predicted); });
}

bool one_step(Model& model) {
  std::map<int, std::pair<int, int>> sample_of;  // of a register: channel and lag
  for (LaggedQuantity const& lagged : model.lagged_quantities)
    if (auto const channel = channel_of(model, lagged))
      for (std::size_t k = 0; k < lagged.registers.size(); ++k)
        sample_of[lagged.registers[k]] = {*channel, static_cast<int>(k) + 1};
  auto const has_measured = [&](Node const& node) { return is_leaf(node, LeafKind::measured) && node.lag > 0; };
  bool reads_data = false;
  each_root(model, [&](NodeId root) { reads_data = reads_data || model.graph.depends(root, has_measured); });
  if (sample_of.empty() && !reads_data) return false;
  auto const measured = [&](NodeId leaf) -> std::optional<NodeId> {
    Node const node = model.graph[leaf];
    if (node.leaf_kind != LeafKind::state || !sample_of.contains(node.index)) return std::nullopt;
    auto const [channel, lag] = sample_of.at(node.index);
    return model.graph.leaf(LeafKind::measured, channel, Stage::begin, lag);
  };
  each_root(model, [&](NodeId& root) { replace(model.graph, root, measured); });
  drop_unread_states(model);
  return true;
}

}  // namespace

std::string_view prediction_name(PredictionRule rule) {
  switch (rule) {
    case PredictionRule::as_written:
      return "as_written";
    case PredictionRule::one_step:
      return "one_step";
    case PredictionRule::free_run:
      return "free_run";
  }
  return "?";
}

std::optional<int> lay_out_lags(Model& model, std::vector<std::optional<NodeId>> const& initial) {
  std::map<int, int> most;
  each_root(model, [&](NodeId root) {
    for (NodeId const id : model.graph.reachable({&root, 1})) {
      Node const& node = model.graph[id];
      if (is_leaf(node, LeafKind::previous)) most[node.index] = std::max(most[node.index], node.lag);
    }
  });
  for (auto const& [index, lags] : most) {
    auto const p = static_cast<std::size_t>(index);
    int const channel = model.lagged_quantities[p].channel;
    if (channel < 0 && !initial[p]) return index;
    add_registers(model, p, lags, channel < 0 ? *initial[p] : measured_leaf(model, channel));
  }
  each_root(model, [&](NodeId& root) {
    replace(model.graph, root, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const node = model.graph[leaf];
      if (node.leaf_kind != LeafKind::previous) return std::nullopt;
      return register_leaf(model, model.lagged_quantities[static_cast<std::size_t>(node.index)], node.lag);
    });
  });
  return std::nullopt;
}

std::optional<Model> with_prediction(Model model, PredictionRule rule) {
  if (rule == PredictionRule::free_run) free_run(model);
  if (rule == PredictionRule::one_step && !one_step(model)) return std::nullopt;
  return model;
}

void remove_processes(Model& model) {
  each_root(model, [&](NodeId& root) { root = without_processes(model.graph, root); });
  model.processes.clear();
}

bool feeds_back(Model const& model) {
  return std::any_of(model.states.begin(), model.states.end(), [&](State const& state) {
    return model.graph.depends(state.derivative, [](Node const& node) { return is_leaf(node, LeafKind::process); });
  });
}

bool same_step(double step, double declared) { return std::abs(step - declared) <= 0.01 * declared; }

int data_lag(Model const& model) {
  int most = 0;
  auto const look = [&](NodeId root) {
    for (NodeId const id : model.graph.reachable({&root, 1})) {
      Node const& node = model.graph[id];
      if (node.operation == Operation::leaf && node.leaf_kind != LeafKind::previous) most = std::max(most, node.lag);
    }
  };
  for (State const& state : model.states) {
    look(state.derivative);
    look(state.initial);
  }
  for (Channel const& channel : model.channels)
    for (NodeId const argument : channel.noise.arguments) look(argument);
  for (Derived const& derived : model.derived) look(derived.value);
  for (Process const& process : model.processes)
    for (NodeId const argument : process.arguments) look(argument);
  return most;
}

std::vector<PastSample> lagged_samples(Model const& model, int channel) {
  std::vector<NodeId> roots;
  if (channel >= 0) {
    roots = model.channels[static_cast<std::size_t>(channel)].noise.arguments;
    for (Process const& process : model.processes)
      if (process.channel == channel) roots.insert(roots.end(), process.arguments.begin(), process.arguments.end());
  } else {
    for (State const& state : model.states) roots.push_back(channel == -1 ? state.derivative : state.initial);
  }
  std::vector<PastSample> samples;
  for (NodeId const id : model.graph.reachable(roots))
    if (is_leaf(model.graph[id], LeafKind::measured)) samples.push_back({model.graph[id].index, model.graph[id].lag});
  return samples;
}

}  // namespace sysid
