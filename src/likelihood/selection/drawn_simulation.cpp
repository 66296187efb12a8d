// Leaves of disturbances become products of their size and a parameter.
#include "likelihood/selection/drawn_simulation.hpp"

#include <cmath>

#include "model/replaced_disturbances.hpp"

namespace sysid {

DrawnSimulation drawn_simulation(Model model) {
  DrawnSimulation drawn;
  drawn.first = static_cast<int>(model.parameters.size());
  Graph& graph = model.graph;
  auto const number = [&](std::string const& of) {
    Parameter parameter;
    parameter.name = "random part of " + of;
    model.parameters.push_back(std::move(parameter));
    return graph.leaf(LeafKind::parameter, static_cast<int>(model.parameters.size()) - 1);
  };
  for (State& state : model.states) {
    if (!state.initial_variance) continue;
    NodeId const sd = graph.unary(Operation::square_root, *state.initial_variance);
    state.initial = graph.add(state.initial, graph.multiply(sd, number(state.name + "(0)")));
    state.initial_variance.reset();
    ++drawn.starts;
  }
  std::vector<NodeId> values;
  for (Disturbance const& each : model.disturbances) {
    NodeId const drawn_number = number(each.name);
    values.push_back(graph.multiply(graph.unary(Operation::square_root, each.intensity), drawn_number));
    drawn.white.push_back(model.dynamics == Dynamics::continuous && !each.held);
  }
  replace_disturbances(model, values);
  drawn.model = std::move(model);
  return drawn;
}

void DrawnSimulation::write(Experiment const& experiment, int sample, StreamKey key, Lanes parameters, int lane) const {
  Stream at_start(key);
  for (int k = 0; k < starts; ++k) parameters(first + k, lane) = at_start.normal();
  auto const i = static_cast<std::size_t>(sample);
  Stream stream(key.with_step(key.step + 1 + static_cast<std::uint64_t>(sample)));
  for (std::size_t d = 0; d < white.size(); ++d) {
    double const width = i + 1 < experiment.time.size() ? experiment.time[i + 1] - experiment.time[i] : 1;
    double const value = stream.normal();
    parameters(first + starts + static_cast<int>(d), lane) = white[d] ? value / std::sqrt(width) : value;
  }
}

}  // namespace sysid
