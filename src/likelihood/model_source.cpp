// Parameters that are fixed, memories and unknowns find their places; random states become their moments.
#include "likelihood/model_source.hpp"

#include <algorithm>
#include <utility>

#include "distribution/normal_approximation.hpp"
#include "expression/finite_slope.hpp"
#include "solver/solver.hpp"

namespace sysid {
namespace {

// a - b with equal addends cancelled, so that a residual does not carry the rounding of constants both have.
class Difference {
 public:
  explicit Difference(Graph& graph) : graph_(graph) {}
  NodeId operator()(NodeId a, NodeId b) {
    collect(a, 1);
    collect(b, -1);
    NodeId sum = graph_.constant(0);
    for (auto const& [node, count] : terms_)
      if (count != 0) sum = graph_.add(sum, graph_.multiply(graph_.constant(count), node));
    return sum;
  }

 private:
  void collect(NodeId id, int sign) {
    Node const node = graph_[id];
    if (node.operation == Operation::add || node.operation == Operation::subtract) {
      collect(node.a, sign);
      collect(node.b, node.operation == Operation::add ? sign : -sign);
    } else if (node.operation == Operation::negate) {
      collect(node.a, -sign);
    } else {
      auto const place = std::find_if(terms_.begin(), terms_.end(), [&](auto const& term) { return term.first == id; });
      if (place == terms_.end())
        terms_.emplace_back(id, sign);
      else
        place->second += sign;
    }
  }
  Graph& graph_;
  std::vector<std::pair<NodeId, int>> terms_;
};

SimulationSource dynamics(Folded& folded, CompiledModel const& compiled) {
  Model const& model = compiled.model;
  bool const free_start = compiled.free_start;
  SimulationSource source;
  source.integrator = compiled.method;
  int const all = static_cast<int>(model.parameters.size());
  source.parameters = all + (free_start ? static_cast<int>(model.states.size()) : 0);
  source.inputs = static_cast<int>(model.inputs.size());
  for (std::size_t i = 0; i < model.states.size(); ++i) {
    bool const estimated = free_start && !model.states[i].initial_variance;  // a random initial value keeps its law
    source.initial.push_back(estimated ? folded.graph.leaf(LeafKind::parameter, all + static_cast<int>(i))
                                       : folded(model.states[i].initial));
    source.derivative.push_back(folded(model.states[i].derivative));
  }
  source.map = model.dynamics == Dynamics::discrete;
  // What is remembered begins as it is at the first sample.
  for (NodeId const memory : model.memories) {
    source.memories.push_back(folded(memory));
    source.initial.push_back(folded.graph.substitute(source.memories.back(), [&](NodeId leaf) -> std::optional<NodeId> {
      Node const& node = folded.graph[leaf];
      if (node.leaf_kind != LeafKind::state) return std::nullopt;
      return source.initial[static_cast<std::size_t>(node.index)];
    }));
    source.derivative.push_back(folded.graph.constant(0));
  }
  if (!keeps_unknowns(compiled)) return source;
  for (std::size_t j = 0; j < model.unknowns.size(); ++j) {
    Unknown const& unknown = model.unknowns[j];
    source.initial.push_back(folded(unknown.guess));
    source.constraints.push_back(folded(model.residuals[j]));
    if (unknown.component >= 0)
      source.derivative[static_cast<std::size_t>(unknown.component)] =
          folded.graph.leaf(LeafKind::state, static_cast<int>(model.states.size() + model.memories.size() + j));
  }
  return source;
}

/// The moments of a model with random states, and the noise that they give its channels together with that of the sensors. Noise
/// that is not normal counts as the nearest normal one.
void filter(Folded& folded, CompiledModel const& compiled, bool since, ModelSource& source) {
  Model const& model = compiled.model;
  Graph& graph = folded.graph;
  RandomStates random;
  for (Disturbance const& each : model.disturbances) random.noises.push_back({folded(each.intensity), each.held});
  for (State const& state : model.states)
    random.initial_variances.push_back(state.initial_variance ? std::optional(folded(*state.initial_variance)) : std::nullopt);
  random.by_slopes = true;
  std::vector<NormalChannel> channels;
  for (Distribution& noise : source.noise) noise = normal_approximation(graph, noise);
  for (Distribution const& noise : source.noise)
    channels.push_back({noise.arguments[0], graph.multiply(noise.arguments[1], noise.arguments[1])});
  source.dynamics.graph = graph;
  source.moments =
      with_moments(std::move(source.dynamics), random, channels,
                   compiled.filter == FilterRule::unscented ? MomentRule::sigma_points : MomentRule::linearised, since);
  graph = source.moments->source.graph;
  source.dynamics = source.moments->source;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    Innovation const& expected = source.moments->channels[c];
    source.noise[c].arguments = {expected.mean, graph.unary(Operation::square_root, expected.variance)};
    source.correct[c] = expected.correct;
  }
}

}  // namespace

NodeId Folded::operator()(NodeId root) {
  NodeId const result = graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
    Node const node = graph[leaf];
    auto const state = static_cast<int>(model_.states.size()) + node.index;
    if (node.leaf_kind == LeafKind::previous) return graph.leaf(LeafKind::state, state);  // a memory: it is kept behind the states
    if (node.leaf_kind == LeafKind::unknown && unknowns_are_states_)
      return graph.leaf(LeafKind::state, state + static_cast<int>(model_.memories.size()));
    if (node.leaf_kind != LeafKind::parameter || static_cast<std::size_t>(node.index) >= model_.parameters.size())
      return std::nullopt;
    return model_.parameters[static_cast<std::size_t>(node.index)].value_of_all();
  });
  return result;
}

Distribution Folded::operator()(Distribution use) {
  for (NodeId& argument : use.arguments) argument = (*this)(argument);
  if (use.lower) use.lower = (*this)(*use.lower);
  if (use.upper) use.upper = (*this)(*use.upper);
  return use;
}

bool keeps_unknowns(CompiledModel const& compiled) {
  return !compiled.model.unknowns.empty() && find_solver(compiled.method)->implicit;
}

ModelSource source_of(Folded& folded, CompiledModel const& compiled, bool since) {
  ModelSource source;
  source.dynamics = dynamics(folded, compiled);
  for (Channel const& channel : compiled.model.channels) source.noise.push_back(folded(channel.noise));
  source.correct.resize(source.noise.size());
  if (compiled.model.filtered()) filter(folded, compiled, since, source);
  return source;
}

ChannelSource ModelSource::channel(std::size_t index, std::vector<NodeId> sums) const {
  return {std::move(sums), correct[index], false};
}

NodeId ModelSource::variance(Graph& graph, NodeId expression) const {
  NodeId sum = graph.constant(0);
  if (!moments) return sum;
  std::vector<NodeId> slopes;
  for (std::size_t i = 0; i < moments->means; ++i)
    slopes.push_back(finite_slope(graph, expression, graph.leaf(LeafKind::state, static_cast<int>(i))));
  for (std::size_t i = 0; i < moments->means; ++i)
    for (std::size_t j = 0; j < moments->means; ++j)
      sum = graph.add(sum,
                      graph.multiply(graph.multiply(slopes[i], slopes[j]), moments->of(static_cast<int>(i), static_cast<int>(j))));
  return sum;
}

ChannelDensity channel_density(Graph& graph, Distribution const& use, Channel const& channel, int index) {
  NodeId const measured = graph.leaf(LeafKind::measured, index);
  NodeId const centre = use.row->centre(graph, use.arguments);
  // A count has a probability, not a density per unit.
  NodeId const unit = graph.constant(use.row->discrete ? 0.0 : elementary::log(channel.to_si(1)));
  return {graph.add(log_density(graph, use, measured), unit), graph.add(use.row->saturated(graph, measured, use.arguments), unit),
          centre};
}

NodeId deviance_residual(Graph& graph, ChannelDensity const& density, int index) {
  NodeId const measured = graph.leaf(LeafKind::measured, index);
  NodeId const deviance = Difference(graph)(density.saturated, density.sample);
  NodeId const size = graph.unary(Operation::square_root,
                                  graph.binary(Operation::maximum, graph.multiply(graph.constant(2), deviance), graph.constant(0)));
  return graph.multiply(graph.unary(Operation::sign, graph.subtract(measured, density.centre)), size);
}

NodeId standardised(Graph& graph, Distribution const& noise, int index) {
  return graph.divide(graph.subtract(graph.leaf(LeafKind::measured, index), noise.arguments[0]), noise.arguments[1]);
}

}  // namespace sysid
