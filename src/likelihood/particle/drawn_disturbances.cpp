// Leaves of disturbances become leaves of inputs.
#include "likelihood/particle/drawn_disturbances.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "model/replaced_disturbances.hpp"

namespace sysid {

DrawnDisturbances draw_disturbances(Model model, ConstLanes parameters, Experiment experiment, StreamKey key, int pieces) {
  constexpr std::uint64_t starts = 1u << 20;
  Graph& graph = model.graph;
  auto const value = [&](NodeId id) {
    return graph.evaluate(id, [&](NodeId leaf) {
      Node const& node = graph[leaf];
      auto const p = static_cast<std::size_t>(node.index);
      if (node.leaf_kind != LeafKind::parameter || p >= model.parameters.size()) return std::nan("");
      Parameter const& parameter = model.parameters[p];
      return std::isnan(parameters(node.index, 0)) && parameter.value
                 ? graph.constant_value(*parameter.value).value_or(std::nan(""))
                 : parameters(node.index, 0);
    });
  };
  bool const continuous = model.dynamics == Dynamics::continuous;
  int const first = static_cast<int>(model.inputs.size());
  experiment.inputs.erase(experiment.inputs.begin() + first, experiment.inputs.end());
  for (std::size_t d = 0; d < model.disturbances.size(); ++d) {
    Disturbance const& disturbance = model.disturbances[d];
    double const intensity = value(disturbance.intensity);
    Stream stream(key.with_step(d));
    std::vector<double> begin, end;
    int const lines = continuous && !disturbance.held ? pieces : 1;
    for (std::size_t i = 0; i < experiment.time.size(); ++i)
      for (int k = 0; k < lines; ++k) {
        bool const white = continuous && !disturbance.held && i + 1 < experiment.time.size();
        double const sd = std::sqrt(white ? intensity * lines / (experiment.time[i + 1] - experiment.time[i]) : intensity);
        double const mean = sd * stream.normal(), slope = white ? sd * std::sqrt(3.0) * stream.normal() : 0;
        begin.push_back(mean - slope);
        end.push_back(mean + slope);
      }
    experiment.inputs.push_back(continuous ? InputSignal::lines(experiment.time, begin, end, lines)
                                           : InputSignal(InputRule::zero_order, experiment.time, std::move(begin)));
    Quantity input = disturbance;
    input.name += " (drawn)";
    model.inputs.push_back(std::move(input));
  }
  std::vector<NodeId> inputs;
  for (std::size_t d = 0; d < model.disturbances.size(); ++d)
    inputs.push_back(graph.leaf(LeafKind::input, first + static_cast<int>(d)));
  replace_disturbances(model, inputs);
  Stream stream(key.with_step(starts));
  for (State& state : model.states) {
    if (!state.initial_variance) continue;
    double const sd = std::sqrt(value(*state.initial_variance));
    state.initial = graph.add(state.initial, graph.constant(sd * stream.normal()));
    state.initial_variance.reset();
  }
  return {std::move(model), std::move(experiment)};
}

}  // namespace sysid
