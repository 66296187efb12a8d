// From expressions to kernels and programs: densities of channels, residuals, trajectories.
#include "likelihood/compiled_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "model/dump.hpp"

#include "likelihood/differentiated.hpp"
#include "likelihood/model_source.hpp"
#include "likelihood/parameter_space.hpp"
#include "program/adjoint.hpp"
#include "program/tangents.hpp"
#include "solver/solver.hpp"

namespace sysid {
namespace {

void compile_kernels(CompiledModel& compiled) {
  Model const& model = compiled.model;
  Folded folded(model);
  Graph& graph = folded.graph;
  std::vector<NodeId> leaves, quantities, initial;
  for (std::size_t i = 0; i < model.parameters.size(); ++i) leaves.push_back(graph.leaf(LeafKind::parameter, static_cast<int>(i)));
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

/// Of what is shown: the sd that random states give it.
void record_spreads(CompiledModel& compiled, Folded& folded, ModelSource const& source, SimulationSource& trajectory) {
  using Kind = CompiledModel::Record::Kind;
  std::size_t const shown = compiled.records.size();
  for (std::size_t r = 0; r < shown; ++r) {
    Kind const kind = compiled.records[r].kind;
    if (kind != Kind::centre && kind != Kind::state && kind != Kind::derived) continue;
    NodeId const variance = source.variance(folded.graph, trajectory.records[r]);
    if (folded.graph.is_constant(variance, 0)) continue;
    NodeId const zero = folded.graph.constant(0);
    trajectory.records.push_back(
        folded.graph.unary(Operation::square_root, folded.graph.binary(Operation::maximum, variance, zero)));
    compiled.records.push_back({Kind::spread, static_cast<int>(r), 0});
  }
}

void compile_programs(CompiledModel& compiled) {
  Model const& model = compiled.model;
  Folded folded(model, keeps_unknowns(compiled));
  ModelSource const source = source_of(folded, compiled);
  SimulationSource likelihood = source.dynamics, residuals = likelihood, trajectory = likelihood;
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    int const index = static_cast<int>(c);
    ChannelDensity const density = channel_density(folded.graph, source.noise[c], model.channels[c], index);
    likelihood.channels.push_back(source.channel(c, {density.sample}));
    residuals.channels.push_back(source.channel(c, {density.saturated}));
    residuals.records.push_back(source.moments ? standardised(folded.graph, source.noise[c], index)
                                               : deviance_residual(folded.graph, density, index));
    residuals.recorded_at.push_back(source.recorded_with(c));
    trajectory.channels.push_back(source.channel(c, {}));
    compiled.records.push_back({CompiledModel::Record::Kind::centre, static_cast<int>(c), 0});
    trajectory.records.push_back(density.centre);
    Distribution const& use = source.noise[c];
    compiled.noise.push_back(use.row);
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
  if (source.moments) record_spreads(compiled, folded, source, trajectory);
  compiled.likelihood = finish(folded, std::move(likelihood));
  compiled.residuals = finish(folded, std::move(residuals));
  compiled.trajectory = finish(folded, std::move(trajectory));
}

/// Behind the means come the covariances that there are, or their factors.
ProgramNames filtered_names(CompiledModel const& compiled, ProgramNames names) {
  Folded folded(compiled.model);
  ModelSource const source = source_of(folded, compiled);
  for (auto const& [i, j] : source.moments->entries) {
    auto const &a = names.states[static_cast<std::size_t>(i)], &b = names.states[static_cast<std::size_t>(j)];
    names.states.push_back(!source.moments->factored ? fmt::format("cov({}, {})", a, b)
                           : i == j                  ? fmt::format("D({})", a)
                                                     : fmt::format("U({}, {})", b, a));
  }
  for (Channel const& channel : compiled.model.channels) names.channels.push_back(channel.name);
  return names;
}

ProgramNames names_of(CompiledModel const& compiled) {
  ProgramNames names;
  for (Parameter const& parameter : compiled.model.parameters) names.parameters.push_back(parameter.name);
  if (compiled.free_start)
    for (State const& state : compiled.model.states) names.parameters.push_back(state.name + "(0)");
  for (Quantity const& input : compiled.model.inputs) names.inputs.push_back(input.name);
  for (State const& state : compiled.model.states) names.states.push_back(state.name);
  if (compiled.model.filtered()) return filtered_names(compiled, std::move(names));
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
  compiled->filter = filter;
  compiled->model = std::move(model);
  compiled->free_start = free_start;
  compiled->method = method;
  compile_kernels(*compiled);
  compile_programs(*compiled);
  if (!free_start) choose_derivatives(*compiled);
  return compiled;
}

namespace {

/// The model with a graph that has more expressions; add: what of them is summed and recorded.
template <class Add>
std::shared_ptr<SimulationProgram const> compile_grown(CompiledModel const& compiled, Graph grown, Add const& add) {
  Model model = compiled.model;
  model.graph = std::move(grown);
  Folded folded(model, keeps_unknowns(compiled));
  ModelSource const of = source_of(folded, compiled);
  SimulationSource source = of.dynamics;
  add(folded, of, source);
  return finish(folded, std::move(source));
}

}  // namespace

std::shared_ptr<SimulationProgram const> compile_sums(CompiledModel const& compiled, Graph grown,
                                                      std::span<NodeId const> per_channel) {
  return compile_grown(compiled, std::move(grown), [&](Folded& folded, ModelSource const& of, SimulationSource& source) {
    for (NodeId const expression : per_channel) source.channels.push_back(of.channel(source.channels.size(), {folded(expression)}));
  });
}

std::shared_ptr<SimulationProgram const> compile_records(CompiledModel const& compiled, Graph grown,
                                                         std::span<NodeId const> per_channel) {
  return compile_grown(compiled, std::move(grown), [&](Folded& folded, ModelSource const& of, SimulationSource& source) {
    for (std::size_t c = 0; c < per_channel.size(); ++c) {
      source.channels.push_back(of.channel(c, {}));
      source.records.push_back(folded(per_channel[c]));
      source.recorded_at.push_back(of.recorded_with(c));
    }
  });
}

std::shared_ptr<SimulationProgram const> compile_densities(CompiledModel const& compiled, bool ahead) {
  Folded folded(compiled.model, keeps_unknowns(compiled));
  ModelSource const of = source_of(folded, compiled);
  SimulationSource source = of.dynamics;
  for (std::size_t c = 0; c < compiled.model.channels.size(); ++c) {
    source.channels.push_back(of.channel(c, {}));
    source.records.push_back(channel_density(folded.graph, of.noise[c], compiled.model.channels[c], static_cast<int>(c)).sample);
    source.recorded_at.push_back(ahead ? before_channels : of.recorded_with(c));
  }
  return finish(folded, std::move(source));
}

std::shared_ptr<SimulationProgram const> CompiledModel::squares() const {
  return squares_.get([&] {
    Folded folded(model, keeps_unknowns(*this));
    Graph& graph = folded.graph;
    ModelSource const of = source_of(folded, *this);
    SimulationSource source = of.dynamics;
    for (std::size_t c = 0; c < model.channels.size(); ++c) {
      int const index = static_cast<int>(c);
      ChannelDensity const density = channel_density(graph, of.noise[c], model.channels[c], index);
      Distribution const& use = of.noise[c];
      source.channels.push_back(of.channel(c, {density.saturated}));
      source.records.push_back(use.row->gaussian ? standardised(graph, use, index) : deviance_residual(graph, density, index));
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

/// A state of the program behind those of the model.
std::string further_state(Model const& model, std::size_t index) {
  if (model.filtered()) return "a covariance";
  std::size_t const memories = model.memories.size();
  return index >= memories && index - memories < model.unknowns.size() ? model.unknowns[index - memories].name : "the value before";
}

/// As the user wrote it, and where.
std::string describe_place(Model const& model, Graph const& graph, NodeId node, Source const& source) {
  if (auto const span = graph.span(node)) return placed(*span, source);
  std::string text = graph.format(node, [&](NodeId leaf) -> std::string {
    Node what = graph[leaf];
    auto const index = static_cast<std::size_t>(what.index);
    if (what.leaf_kind == LeafKind::state && index >= model.states.size()) return further_state(model, index - model.states.size());
    if (what.lag > 0) {
      int const lag = std::exchange(what.lag, 0);
      return fmt::format("lag({}, {})", leaf_name(model, what), lag);
    }
    switch (what.leaf_kind) {
      case LeafKind::parameter:
        return index < model.parameters.size() ? model.parameters[index].name
                                               : model.states[index - model.parameters.size()].name + "(0)";
      case LeafKind::state:
        return model.states[index].name;
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

}  // namespace

std::string describe(Model const& model, Graph const& graph, NodeId node, Source const& source) {
  bool const divides = graph[node].operation == Operation::divide;
  bool const by_zero = divides && graph.constant_value(graph[node].b) == 0.0;
  return describe_place(model, graph, node, source) + (by_zero ? " (its divisor is the constant 0)" : "");
}

}  // namespace sysid
