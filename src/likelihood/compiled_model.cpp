// From expressions to kernels and programs: densities of channels, residuals, trajectories.
#include "likelihood/compiled_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "model/dump.hpp"

#include "likelihood/differentiated.hpp"
#include "likelihood/parameter_space.hpp"
#include "program/adjoint.hpp"
#include "program/tangents.hpp"
#include "solver/solver.hpp"

namespace sysid {
namespace {

NodeId parameter_leaf(Graph& graph, int index) { return graph.leaf(LeafKind::parameter, index); }

// The graph of a model with parameters that are fixed for all experiments replaced by their values; the replaced roots share it.
class Folded {
 public:
  /// unknowns_are_states: leaf unknown(j) is the state that comes j places after the model's own (algebraic states of IDA).
  explicit Folded(Model const& model, bool unknowns_are_states = false)
      : model_(model), unknowns_are_states_(unknowns_are_states), graph(model.graph) {}

  NodeId operator()(NodeId root) {
    NodeId const result = graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const node = graph[leaf];
      auto const state = static_cast<int>(model_.states.size()) + node.index;
      if (node.leaf_kind == LeafKind::previous)
        return graph.leaf(LeafKind::state, state);  // a memory: it is kept behind the states
      if (node.leaf_kind == LeafKind::unknown && unknowns_are_states_)
        return graph.leaf(LeafKind::state, state + static_cast<int>(model_.memories.size()));
      if (node.leaf_kind != LeafKind::parameter || static_cast<std::size_t>(node.index) >= model_.parameters.size())
        return std::nullopt;
      Parameter const& parameter = model_.parameters[static_cast<std::size_t>(node.index)];
      return parameter.per_experiment ? std::nullopt : parameter.value;
    });
    return result;
  }
  Distribution operator()(Distribution use) {
    for (NodeId& argument : use.arguments) argument = (*this)(argument);
    if (use.lower) use.lower = (*this)(*use.lower);
    if (use.upper) use.upper = (*this)(*use.upper);
    return use;
  }

 private:
  Model const& model_;
  bool unknowns_are_states_;

 public:
  Graph graph;
};

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

// log density of a channel's sample in the declared unit; the largest any location gives it; and where the noise is centred.
struct ChannelDensity {
  NodeId sample, saturated, centre;
};
ChannelDensity channel_density(Folded& folded, Channel const& channel, int index) {
  Graph& graph = folded.graph;
  Distribution const use = folded(channel.noise);
  NodeId const measured = graph.leaf(LeafKind::measured, index);
  NodeId const centre = use.row->centre(graph, use.arguments);
  // A count has a probability, not a density per unit.
  NodeId const unit = graph.constant(use.row->discrete ? 0.0 : elementary::log(channel.to_si(1)));
  return {graph.add(log_density(graph, use, measured), unit), graph.add(use.row->saturated(graph, measured, use.arguments), unit),
          centre};
}

// sign(y - centre) sqrt(2 (saturated - log p(y)))
NodeId deviance_residual(Graph& graph, ChannelDensity const& density, int index) {
  NodeId const measured = graph.leaf(LeafKind::measured, index);
  NodeId const deviance = Difference(graph)(density.saturated, density.sample);
  NodeId const size = graph.unary(Operation::square_root,
                                  graph.binary(Operation::maximum, graph.multiply(graph.constant(2), deviance), graph.constant(0)));
  return graph.multiply(graph.unary(Operation::sign, graph.subtract(measured, density.centre)), size);
}

// Whether a program keeps the model's unknowns as algebraic states: not where they could be solved for and the solver wants y' = f.
bool keeps_unknowns(CompiledModel const& compiled) {
  return !compiled.model.unknowns.empty() && find_solver(compiled.method)->implicit;
}

SimulationSource dynamics(Folded& folded, CompiledModel const& compiled) {
  Model const& model = compiled.model;
  bool const free_start = compiled.free_start;
  SimulationSource source;
  source.integrator = compiled.method;
  int const all = static_cast<int>(model.parameters.size());
  source.parameters = all + (free_start ? static_cast<int>(model.states.size()) : 0);
  source.inputs = static_cast<int>(model.inputs.size());
  for (std::size_t i = 0; i < model.states.size(); ++i) {
    source.initial.push_back(free_start ? parameter_leaf(folded.graph, all + static_cast<int>(i))
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

void compile_kernels(CompiledModel& compiled) {
  Model const& model = compiled.model;
  Folded folded(model);
  Graph& graph = folded.graph;
  std::vector<NodeId> leaves, quantities, initial;
  for (std::size_t i = 0; i < model.parameters.size(); ++i) leaves.push_back(parameter_leaf(graph, static_cast<int>(i)));
  for (std::size_t i = 0; i < model.derived.size(); ++i) {
    if (model.derived[i].per_sample) continue;
    compiled.derived_index.push_back(static_cast<int>(i));
    quantities.push_back(graph.divide(folded(model.derived[i].value), graph.constant(model.derived[i].to_si(1))));
  }
  // Where a start is estimated, measured samples play no part in the first guess.
  for (State const& state : model.states)
    initial.push_back(graph.substitute(folded(state.initial), [&](NodeId leaf) -> std::optional<NodeId> {
      return graph[leaf].leaf_kind == LeafKind::measured ? std::optional(graph.constant(0)) : std::nullopt;
    }));
  compiled.derived = compile_kernel(graph, leaves, quantities);
  compiled.initial = compile_kernel(graph, leaves, initial);
}

std::shared_ptr<SimulationProgram const> finish(Folded& folded, SimulationSource source) {
  source.graph = folded.graph;
  return std::make_shared<SimulationProgram const>(compile(std::move(source)));
}

void compile_programs(CompiledModel& compiled) {
  Model const& model = compiled.model;
  Folded folded(model, keeps_unknowns(compiled));
  std::vector<ChannelDensity> densities;
  for (std::size_t c = 0; c < model.channels.size(); ++c)
    densities.push_back(channel_density(folded, model.channels[c], static_cast<int>(c)));

  SimulationSource likelihood = dynamics(folded, compiled), residuals = likelihood, trajectory = likelihood;
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    likelihood.channels.push_back({{densities[c].sample}});
    residuals.channels.push_back({{densities[c].saturated}});
    residuals.records.push_back(deviance_residual(folded.graph, densities[c], static_cast<int>(c)));
    trajectory.channels.push_back({});
    compiled.records.push_back({CompiledModel::Record::Kind::centre, static_cast<int>(c), 0});
    trajectory.records.push_back(densities[c].centre);
    Distribution const use = folded(model.channels[c].noise);
    for (std::size_t a = 0; a < use.arguments.size(); ++a) {
      compiled.records.push_back({CompiledModel::Record::Kind::noise_argument, static_cast<int>(c), static_cast<int>(a)});
      trajectory.records.push_back(use.arguments[a]);
    }
  }
  // In discrete time states are what is remembered; their present values are among the derived quantities.
  for (std::size_t s = 0; s < model.states.size() && model.dynamics != Dynamics::discrete; ++s) {
    compiled.records.push_back({CompiledModel::Record::Kind::state, static_cast<int>(s), 0});
    trajectory.records.push_back(folded.graph.leaf(LeafKind::state, static_cast<int>(s)));
  }
  for (std::size_t d = 0; d < model.derived.size(); ++d) {
    if (!model.derived[d].per_sample) continue;
    compiled.records.push_back({CompiledModel::Record::Kind::derived, static_cast<int>(d), 0});
    trajectory.records.push_back(folded(model.derived[d].value));
  }
  for (std::size_t i = 0; i < model.invariants.size(); ++i) {
    compiled.records.push_back({CompiledModel::Record::Kind::constraint, static_cast<int>(i), 0});
    trajectory.records.push_back(folded(model.invariants[i].value));
    compiled.records.push_back({CompiledModel::Record::Kind::constraint_size, static_cast<int>(i), 0});
    trajectory.records.push_back(folded(model.invariants[i].size));
  }
  compiled.likelihood = finish(folded, std::move(likelihood));
  compiled.residuals = finish(folded, std::move(residuals));
  compiled.trajectory = finish(folded, std::move(trajectory));
}

ProgramNames names_of(CompiledModel const& compiled) {
  ProgramNames names;
  for (Parameter const& parameter : compiled.model.parameters) names.parameters.push_back(parameter.name);
  if (compiled.free_start)
    for (State const& state : compiled.model.states) names.parameters.push_back(state.name + "(0)");
  for (Quantity const& input : compiled.model.inputs) names.inputs.push_back(input.name);
  for (State const& state : compiled.model.states) names.states.push_back(state.name);
  for (std::size_t i = 0; i < compiled.model.memories.size(); ++i) names.states.push_back(fmt::format("previous({})", i));
  if (keeps_unknowns(compiled))
    for (Unknown const& unknown : compiled.model.unknowns) names.states.push_back(unknown.name);
  for (Channel const& channel : compiled.model.channels) names.channels.push_back(channel.name);
  return names;
}

void choose_derivatives(CompiledModel& compiled) {
  SimulationSource const &residuals = compiled.residuals->source, &likelihood = compiled.likelihood->source;
  std::vector<int> const by = differentiable_parameters(compiled.model, residuals);
  if (squares_are_cheap(residuals, static_cast<int>(by.size()))) compiled.differentiated = by;
  compiled.gradient_by = differentiable_parameters(compiled.model, likelihood);
  int const count = static_cast<int>(compiled.gradient_by.size());
  compiled.adjoint = has_adjoint(likelihood) && adjoint_is_cheaper(likelihood, compiled.gradient_by);
  if (!compiled.adjoint && !gradient_is_cheap(likelihood, count)) compiled.gradient_by.clear();
}

}  // namespace

int CompiledModel::parameter_rows() const {
  return static_cast<int>(model.parameters.size()) + (free_start ? static_cast<int>(model.states.size()) : 0);
}

std::shared_ptr<CompiledModel const> compile(Model model, bool free_start, std::string const& method, FilterRule filter) {
  auto compiled = std::make_shared<CompiledModel>();
  compiled->model = std::move(model);
  compiled->free_start = free_start;
  compiled->method = method;
  compiled->filter = filter;
  compile_kernels(*compiled);
  compile_programs(*compiled);
  if (!free_start) choose_derivatives(*compiled);
  return compiled;
}

std::shared_ptr<SimulationProgram const> compile_sums(CompiledModel const& compiled, Graph grown,
                                                      std::span<NodeId const> per_channel) {
  Model model = compiled.model;
  model.graph = std::move(grown);
  Folded folded(model, keeps_unknowns(compiled));
  SimulationSource source = dynamics(folded, compiled);
  for (NodeId const expression : per_channel) source.channels.push_back({{folded(expression)}});
  return finish(folded, std::move(source));
}

std::shared_ptr<SimulationProgram const> compile_densities(CompiledModel const& compiled) {
  Folded folded(compiled.model, keeps_unknowns(compiled));
  SimulationSource source = dynamics(folded, compiled);
  for (std::size_t c = 0; c < compiled.model.channels.size(); ++c) {
    source.channels.push_back({});
    source.records.push_back(channel_density(folded, compiled.model.channels[c], static_cast<int>(c)).sample);
  }
  return finish(folded, std::move(source));
}

std::shared_ptr<SimulationProgram const> CompiledModel::squares() const {
  return squares_.get([&] {
    Folded folded(model, keeps_unknowns(*this));
    Graph& graph = folded.graph;
    SimulationSource source = dynamics(folded, *this);
    for (std::size_t c = 0; c < model.channels.size(); ++c) {
      int const index = static_cast<int>(c);
      ChannelDensity const density = channel_density(folded, model.channels[c], index);
      Distribution const use = folded(model.channels[c].noise);
      NodeId const measured = graph.leaf(LeafKind::measured, index);
      source.channels.push_back({{density.saturated}});
      source.records.push_back(use.row->gaussian ? graph.divide(graph.subtract(measured, use.arguments[0]), use.arguments[1])
                                                 : deviance_residual(graph, density, index));
    }
    source.graph = graph;
    return std::make_shared<SimulationProgram const>(sysid::compile(with_squares(std::move(source), differentiated)));
  });
}

std::shared_ptr<SimulationProgram const> CompiledModel::gradient() const {
  return gradient_.get([&] {
    SimulationSource source = likelihood->source;
    if (adjoint)
      source.adjoint_by = gradient_by;
    else
      source = with_gradient(std::move(source), gradient_by);
    return std::make_shared<SimulationProgram const>(sysid::compile(std::move(source)));
  });
}

std::string dump_program(CompiledModel const& compiled) {
  return fmt::format("{}\n# likelihood\n{}", ParameterSpace(compiled.model, {{}}).dump(),
                     dump(*compiled.likelihood, names_of(compiled)));
}

namespace {

std::string placed(Span span, Source const& source) {
  Place const place = source.place(span.begin);
  return fmt::format("`{}` ({}:{}:{})", source.text(span), source.name(place.file), place.line, place.column);
}

// The nearest expression of the user's that a node without a place is a part of: a time derivative of a constraint is a part of
// that constraint. Empty when there is none.
std::string enclosing_place(Graph const& graph, NodeId node, Source const& source) {
  std::vector<bool> holds(graph.size(), false);
  holds[node] = true;
  for (NodeId id = node + 1; id < graph.size(); ++id) {
    int const operands = operand_count(graph[id]);
    holds[id] =
        (operands > 0 && holds[graph[id].a]) || (operands > 1 && holds[graph[id].b]) || (operands > 2 && holds[graph[id].c]);
    if (!holds[id]) continue;
    if (auto const span = graph.span(id)) return placed(*span, source);
  }
  return {};
}

}  // namespace

std::string describe(Model const& model, Graph const& graph, NodeId node, Source const& source) {
  if (auto const span = graph.span(node)) return placed(*span, source);
  std::string text = graph.format(node, [&](NodeId leaf) -> std::string {
    Node what = graph[leaf];
    auto const index = static_cast<std::size_t>(what.index);
    if (what.leaf_kind == LeafKind::state && index >= model.states.size()) return "the value before";
    if (what.lag > 0) {
      int const lag = std::exchange(what.lag, 0);
      return fmt::format("lag({}, {})", leaf_name(model, what), lag);
    }
    switch (what.leaf_kind) {
      case LeafKind::parameter:
        return index < model.parameters.size() ? model.parameters[index].name
                                               : model.states[index - model.parameters.size()].name + "(0)";
      case LeafKind::state:
        if (index < model.states.size()) return model.states[index].name;
        if (index < model.states.size() + model.memories.size()) return fmt::format("previous({})", index - model.states.size());
        return model.unknowns[index - model.states.size() - model.memories.size()].name;
      case LeafKind::input:
        return model.inputs[index].name;
      case LeafKind::input_rate:
        return model.inputs[index].name + "'";
      case LeafKind::measured:
        return model.channels[index].name;
      case LeafKind::time:
        return "time";
      case LeafKind::disturbance:
        return model.disturbances[index].name;
      default:
        return "?";
    }
  });
  if (text.size() > 80) text = text.substr(0, 77) + "...";
  std::string const enclosing = enclosing_place(graph, node, source);
  return enclosing.empty() ? fmt::format("`{}`", text) : fmt::format("`{}` in {}", text, enclosing);
}

}  // namespace sysid
