// What expressions read of samples: channels by name, predictions and residuals put in place, lags laid out as registers.
#include "check/model/model_checker.hpp"

#include <algorithm>

#include "check/message/errors.hpp"
#include "check/units/units.hpp"
#include "model/lags.hpp"

namespace sysid {

void ModelChecker::name_samples() {
  SampleNames& samples = scope_.samples();
  samples.states = static_cast<int>(states_.size());
  Diagnostics said_with_the_channel;
  each<ast::Observation>([&](ast::Observation const& observation) {
    samples.channels.emplace(observation.channel.name.text,
                             SampleNames::Channel{static_cast<int>(samples.channels.size()),
                                                  check_unit(observation.channel.unit, said_with_the_channel)});
  });
}

void ModelChecker::finish_samples() {
  Graph& graph = model_.graph;
  int const states = static_cast<int>(states_.size());
  std::vector<NodeId> predicted(model_.channels.size());
  enum class Mark { none, open, done };
  std::vector<Mark> marks(model_.channels.size(), Mark::none);
  bool good = true;
  auto const resolve = [&](auto const& self, NodeId root) -> NodeId {
    return graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const node = graph[leaf];
      if (node.leaf_kind != LeafKind::previous || node.lag != 0) return std::nullopt;
      auto const c = static_cast<std::size_t>(node.index - states);
      Channel const& channel = model_.channels[c];
      if (marks[c] == Mark::open && good) {
        diagnostics_.add(errors::prediction_cycle(channel.span, channel.name));
        good = false;
      }
      if (marks[c] == Mark::none) {
        marks[c] = Mark::open;
        predicted[c] = self(self, channel.noise.row->centre(graph, channel.noise.arguments));
        marks[c] = Mark::done;
      }
      return good ? std::optional(predicted[c]) : std::nullopt;
    });
  };
  for (NodeId const highest : highest_)
    for (NodeId const id : graph.reachable({&highest, 1})) {
      Node const& node = graph[id];
      if (!is_leaf(node, LeafKind::previous) || node.lag != 0 || !good) continue;
      Channel const& channel = model_.channels[static_cast<std::size_t>(node.index - states)];
      diagnostics_.add(errors::present_prediction(graph.span(id).value_or(channel.span), channel.name));
      good = false;
    }
  if (!good) return;
  for (std::size_t c = 0; c < model_.channels.size(); ++c) {
    Channel& channel = model_.channels[c];
    predicted[c] = resolve(resolve, graph.leaf(LeafKind::previous, states + static_cast<int>(c), Stage::begin, 0));
    for (NodeId& argument : channel.noise.arguments) argument = resolve(resolve, argument);
    bool const own = std::any_of(channel.noise.arguments.begin(), channel.noise.arguments.end(), [&](NodeId argument) {
      return graph.depends(argument, [&](Node const& node) {
        return is_leaf(node, LeafKind::measured) && node.index == static_cast<int>(c) && node.lag == 0;
      });
    });
    if (own && good) diagnostics_.add(errors::own_sample(channel.span, channel.name));
  }
  for (Derived& derived : model_.derived) derived.value = resolve(resolve, derived.value);
  for (Expansion& expansion : model_.expansions)
    for (std::vector<NodeId>& application : expansion.applications)
      for (NodeId& argument : application) argument = resolve(resolve, argument);
  if (failed()) return;
  resolve_process_arguments(predicted);
  model_.memories = scope_.samples().memories;
  for (NodeId& memory : model_.memories) memory = solved(memory);
  if (model_.dynamics == Dynamics::discrete)
    lay_out_lags(predicted);
  else if (model_.states.empty() && !reads_input_rate())
    model_.dynamics = Dynamics::none;
  if (!failed()) place_processes();
}

bool ModelChecker::reads_input_rate() const {
  for (NodeId id = 0; id < model_.graph.size(); ++id)
    if (is_leaf(model_.graph[id], LeafKind::input_rate)) return true;
  return false;
}

void ModelChecker::lay_out_lags(std::vector<NodeId> const& predicted) {
  std::vector<std::optional<NodeId>> initial = initial_lags_;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    auto const& [name, info] = states_[i];
    auto const unit = scope_.find(name)->unit;
    model_.lagged_quantities.push_back({{name, unit, info.declaration->name.span}, highest_[i], -1, {}});
    model_.derived.push_back({{name, unit, info.declaration->name.span}, highest_[i], true});
  }
  for (std::size_t c = 0; c < model_.channels.size(); ++c) {
    Channel const& channel = model_.channels[c];
    model_.lagged_quantities.push_back({{channel.name, channel.unit, channel.span}, predicted[c], static_cast<int>(c), {}});
    initial.emplace_back();
  }
  std::size_t const first_disturbance = model_.lagged_quantities.size();
  for (Disturbance const& disturbance : model_.disturbances) {
    model_.lagged_quantities.push_back(
        {{disturbance.name, disturbance.unit, disturbance.span}, model_.graph.leaf(LeafKind::state, disturbance.state), -1, {}});
    initial.push_back(model_.graph.constant(0));
  }
  // What a channel predicts without processes: the parametric part, from which lagged residuals are taken.
  for (std::size_t c = 0; c < model_.channels.size() && !model_.processes.empty(); ++c) {
    Channel const& channel = model_.channels[c];
    std::string const name = "parametric part of predicted(" + channel.name + ")";
    model_.lagged_quantities.push_back({{name, channel.unit, channel.span}, without_processes(model_.graph, predicted[c]), -1, {}});
    initial.push_back(model_.graph.leaf(LeafKind::measured, static_cast<int>(c)));
  }
  if (auto const missing = sysid::lay_out_lags(model_, initial)) {
    LaggedQuantity const& lagged = model_.lagged_quantities[static_cast<std::size_t>(*missing)];
    diagnostics_.add(errors::initial_lag_missing(lagged.span, lagged.name));
    return;
  }
  // Samples before the first are independent of each other, as far as the text says.
  auto const vary = [&](std::size_t lagged, std::optional<NodeId> variance) {
    for (int const index : model_.lagged_quantities[lagged].registers)
      model_.states[static_cast<std::size_t>(index)].initial_variance = variance;
  };
  for (std::size_t i = 0; i < states_.size(); ++i) vary(i, initial_lag_variances_[i]);
  for (std::size_t i = 0; i < model_.disturbances.size(); ++i) vary(first_disturbance + i, model_.disturbances[i].intensity);
}

}  // namespace sysid
