// Channels are distinguished by the location of their noise.
#include "mechanics/measured_motion.hpp"

#include <cmath>
#include <optional>

#include "core/text/diagnostic.hpp"

namespace sysid {

namespace {

using States = std::vector<std::vector<double>>;

bool is_leaf(Node const& node, LeafKind kind) { return node.operation == Operation::leaf && node.leaf_kind == kind; }

/// What a location adds to the displacement of a mass; nothing where it is not the displacement and a constant.
std::optional<double> beside_displacement(Graph& graph, NodeId centre, Mass const& mass, Accelerations const& accelerations,
                                          std::size_t states) {
  bool const reads_else = graph.depends(centre, [&](Node const& node) {
    return node.operation == Operation::leaf && node.leaf_kind != LeafKind::parameter &&
           !(is_leaf(node, LeafKind::state) && node.index == static_cast<int>(mass.displacement));
  });
  if (reads_else) return std::nullopt;
  try {
    NodeId const slope = graph.differentiate(centre, graph.leaf(LeafKind::state, static_cast<int>(mass.displacement)));
    if (!graph.is_constant(slope, 1)) return std::nullopt;
  } catch (InternalError const&) {
    return std::nullopt;  // a function without a derivative
  }
  double const offset = accelerations.value(centre, std::vector<double>(states, 0.0));
  return std::isfinite(offset) ? std::optional(offset) : std::nullopt;
}

/// What a location adds to the acceleration of a mass, [rows]; empty where that depends on the states.
std::vector<double> beside_acceleration(NodeId centre, Mass const& mass, Accelerations const& accelerations, States const& states,
                                        Experiment const& experiment) {
  constexpr double same = 1e-6;
  auto const beside = [&](std::vector<double> const& at, std::vector<double> const& inputs) {
    return accelerations.value(centre, at, inputs) - accelerations.value(mass.acceleration, at, inputs);
  };
  std::vector<double> out;
  for (std::size_t i = 0; i < states.size(); ++i) {
    std::vector<double> const inputs = inputs_at(experiment, i);
    out.push_back(beside(states.front(), inputs));
    double const size = std::fabs(accelerations.value(mass.acceleration, states[i], inputs));
    if (!(std::fabs(beside(states[i], inputs) - out.back()) <= same * size)) return {};
  }
  return out;
}

}  // namespace

std::vector<double> inputs_at(Experiment const& experiment, std::size_t row) {
  std::vector<double> out;
  for (InputSignal const& input : experiment.inputs) out.push_back(input.sample(static_cast<int>(row)));
  return out;
}

MeasuredMotion measured_motion(Model const& model, Graph& graph, Mass const& mass, Accelerations const& accelerations,
                               States const& states, Experiment const& experiment) {
  MeasuredMotion out;
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    std::vector<double> const& measured = experiment.measured[c];
    DistributionRow const& noise = *model.channels[c].noise.row;
    if (measured.empty() || noise.discrete) continue;
    NodeId const centre = noise.centre(graph, model.channels[c].noise.arguments);
    if (!graph.depends(centre, [](Node const& node) { return is_leaf(node, LeafKind::state); })) continue;
    if (auto const offset = beside_displacement(graph, centre, mass, accelerations, model.states.size());
        offset && out.displacement.empty())
      for (std::size_t i = 0; i < states.size(); ++i) out.displacement.push_back(measured[i] - *offset);
    if (!out.acceleration.empty()) continue;
    out.acceleration = beside_acceleration(centre, mass, accelerations, states, experiment);
    for (std::size_t i = 0; i < out.acceleration.size(); ++i) out.acceleration[i] = measured[i] - out.acceleration[i];
  }
  return out;
}

}  // namespace sysid
