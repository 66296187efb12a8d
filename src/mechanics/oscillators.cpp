// Pairs of states whose derivatives chain, and what their accelerations read.
#include "mechanics/oscillators.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text/diagnostic.hpp"

namespace sysid {

namespace {

/// States that are the derivative of another one, by that one's index: [states], -1: none.
std::vector<int> velocities(Model const& model) {
  std::vector<int> of(model.states.size(), -1);
  for (std::size_t i = 0; i < model.states.size(); ++i) {
    Node const& node = model.graph[model.states[i].derivative];
    if (node.operation == Operation::leaf && node.leaf_kind == LeafKind::state) of[i] = node.index;
  }
  return of;
}

/// What a mass reads, from the leaves of its acceleration. mass_of: [states], -1: of none.
std::vector<std::size_t> read_leaves(Graph const& graph, std::vector<int> const& mass_of, std::size_t own, Mass& mass) {
  std::vector<std::size_t> inputs;
  for (NodeId const id : graph.reachable({&mass.acceleration, 1})) {
    Node const& node = graph[id];
    if (node.operation != Operation::leaf || node.leaf_kind == LeafKind::parameter) continue;
    auto const index = static_cast<std::size_t>(node.index);
    if (node.leaf_kind == LeafKind::input) {
      inputs.push_back(index);
    } else if (node.leaf_kind != LeafKind::state) {
      mass.readable = false;
    } else if (mass_of[index] < 0) {
      mass.remembers = true;
    } else if (auto const other = static_cast<std::size_t>(mass_of[index]);
               other != own && std::find(mass.neighbours.begin(), mass.neighbours.end(), other) == mass.neighbours.end()) {
      mass.neighbours.push_back(other);
    }
  }
  return inputs;
}

void split_off_input(Graph& graph, std::size_t input, Mass& mass) {
  mass.input = input;
  NodeId const leaf = graph.leaf(LeafKind::input, static_cast<int>(input));
  try {
    mass.gain = graph.differentiate(mass.acceleration, leaf);
  } catch (InternalError const&) {
    mass.readable = false;  // a function without a derivative reads the input
    return;
  }
  mass.readable = mass.readable && !graph.depends(mass.gain, [](Node const& node) {
    return node.operation == Operation::leaf && node.leaf_kind != LeafKind::parameter;
  });
  mass.at_rest =
      graph.substitute(mass.acceleration, [&](NodeId id) { return id == leaf ? std::optional(graph.constant(0)) : std::nullopt; });
}

}  // namespace

std::vector<Mass> masses(Model const& model, Graph& graph) {
  std::vector<Mass> out;
  if (model.dynamics != Dynamics::continuous) return out;
  std::vector<int> const velocity = velocities(model);
  std::vector<int> mass_of(model.states.size(), -1);
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    if (velocity[i] < 0) continue;
    auto const j = static_cast<std::size_t>(velocity[i]);
    // Of a chain of three derivatives the last two are no oscillator.
    bool const chained = velocity[j] >= 0 || std::find(velocity.begin(), velocity.end(), static_cast<int>(i)) != velocity.end();
    if (chained) continue;
    mass_of[i] = mass_of[j] = static_cast<int>(out.size());
    out.push_back({i, j, model.states[j].derivative, model.states[j].derivative, 0, {}, {}, false, true});
  }
  for (std::size_t m = 0; m < out.size(); ++m) {
    std::vector<std::size_t> const inputs = read_leaves(graph, mass_of, m, out[m]);
    out[m].readable = out[m].readable && inputs.size() < 2;
    if (inputs.size() == 1) split_off_input(graph, inputs.front(), out[m]);
  }
  return out;
}

Accelerations::Accelerations(Model const& model, Graph const& graph, std::vector<Mass> const& masses, ConstLanes parameters,
                             int draw)
    : graph_(graph), masses_(masses), rest_(model.states.size(), 0.0) {
  for (std::size_t p = 0; p < model.parameters.size(); ++p) {
    auto const fixed = model.parameters[p].value ? graph.constant_value(*model.parameters[p].value) : std::nullopt;
    double const given = parameters(static_cast<int>(p), draw);
    parameters_.push_back(std::isfinite(given) || !fixed ? given : *fixed);
  }
}

double Accelerations::value(NodeId node, std::vector<double> const& states, std::vector<double> const& inputs) const {
  return graph_.evaluate(node, [&](NodeId id) {
    Node const& leaf = graph_[id];
    auto const index = static_cast<std::size_t>(leaf.index);
    if (leaf.leaf_kind == LeafKind::parameter) return parameters_[index];
    if (leaf.leaf_kind == LeafKind::input && index < inputs.size()) return inputs[index];
    return leaf.leaf_kind == LeafKind::state ? states[index] : std::numeric_limits<double>::quiet_NaN();
  });
}

double Accelerations::by_link(std::size_t i, std::optional<std::size_t> other, double elongation, double speed) const {
  std::vector<double> states = rest_;
  auto const move = [&](Mass const& mass, double sign) {
    states[mass.displacement] = sign * elongation;
    states[mass.velocity] = sign * speed;
  };
  if (other)
    move(masses_[*other], -1);
  else
    for (Mass const& mass : masses_) move(mass, 1);
  return value(masses_[i].at_rest, states) - value(masses_[i].at_rest, rest_);
}

double Accelerations::gain(std::size_t i) const { return masses_[i].input ? value(masses_[i].gain, rest_) : 0; }

}  // namespace sysid
