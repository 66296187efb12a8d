// Passes over declarations: names into the scope, channels onto states, which derivatives stand somewhere, values of parameters.
#include <algorithm>

#include "check/dictionary/dictionary_checker.hpp"
#include "check/expression/discrete_step.hpp"
#include "check/expression/distributions.hpp"
#include "check/expression/names_used.hpp"
#include "check/message/errors.hpp"
#include "check/units/units.hpp"

namespace sysid {

void DictionaryChecker::declare() {
  ast::TimeDeclaration const* first_time = nullptr;
  ast::DiscreteTimeDeclaration const* first_discrete = nullptr;
  each<ast::DiscreteTimeDeclaration>(
      [&](ast::DiscreteTimeDeclaration const&) { out_.numbers.discrete = scope_.samples().discrete = true; });
  for (ast::DictionaryStatement const& statement : tree_.statements) {
    if (auto const* discrete = std::get_if<ast::DiscreteTimeDeclaration>(&statement)) {
      if (first_discrete != nullptr) diagnostics_.add(errors::time_twice(discrete->span, first_discrete->span));
      if (std::exchange(first_discrete, discrete) != nullptr) continue;
      out_.measured.dynamics = Dynamics::discrete;
      out_.measured.step = declared_step(*discrete, scope_);
    } else if (auto const* time = std::get_if<ast::TimeDeclaration>(&statement)) {
      if (first_time != nullptr) diagnostics_.add(errors::time_twice(time->span, first_time->span));
      if (std::exchange(first_time, time) != nullptr) continue;
      auto const unit = scope_.unit(time->time.unit);
      check_time_unit(unit, time->time.span, diagnostics_);
      scope_.declare(time->time.name, {TimeSymbol{}, unit, time->time.name.span});
    } else if (auto const* inputs = std::get_if<ast::InputDeclaration>(&statement)) {
      for (ast::Declared const& input : inputs->names) declare_input(input);
    } else if (auto const* states = std::get_if<ast::DictionaryStates>(&statement)) {
      for (ast::DictionaryState const& state : states->states) declare_state(state);
    } else if (auto const* parameter = std::get_if<ast::DictionaryParameter>(&statement)) {
      auto const unit = scope_.unit(parameter->name.unit);
      int const index = static_cast<int>(parameters_.size());
      if (scope_.declare(parameter->name.name, {ParameterSymbol{index}, unit, parameter->name.name.span}))
        parameters_.push_back({parameter, unit, {}});
    } else if (auto const* definition = std::get_if<ast::Definition>(&statement)) {
      scope_.declare(definition->name.name,
                     {DefinitionSymbol{definition}, scope_.unit(definition->name.unit), definition->name.name.span});
    } else if (auto const* function = std::get_if<ast::FunctionDefinition>(&statement)) {
      scope_.define_function(*function);
    } else if (auto const* units = std::get_if<ast::CoefficientUnits>(&statement)) {
      for (ast::UnitExpression const& unit : units->units)
        if (auto const known = check_unit(unit, diagnostics_)) allowed_.push_back({*known, unit.span});
    }
  }
}

void DictionaryChecker::declare_input(ast::Declared const& input) {
  auto const unit = scope_.unit(input.unit);
  if (scope_.declare(input.name, {InputSymbol{static_cast<int>(out_.measured.inputs.size())}, unit, input.name.span}))
    out_.measured.inputs.push_back({input.name.text, unit, input.name.span});
}

void DictionaryChecker::declare_state(ast::DictionaryState const& state) {
  auto const unit = scope_.unit(state.unit);
  if (out_.numbers.discrete && state.primes > 0) {
    diagnostics_.add(errors::primes_in_discrete_time({{state.span}, state.name, {}, state.primes}));
    return;
  }
  if (state.primes == 0) {
    if (!scope_.declare(state.name, {StateSymbol{}, unit, state.name.span})) return;
    states_.emplace_back(state.name.text, StateInfo{unit, state.name.span});
  } else if (find_state(state.name.text) == nullptr) {
    diagnostics_.add(errors::derivative_of_nothing(state.name, state.primes));
    return;
  }
  if (!state.channel) {
    if (state.primes > 0) diagnostics_.add(errors::derivative_without_channel(state.name, state.primes));
    return;
  }
  StateInfo& info = *find_state(state.name.text);
  info.measured = true;
  info.most_primes = std::max(info.most_primes, state.primes);
  auto const [place, fresh] = bound_.emplace(state.channel->text, state.channel->span);
  if (!fresh) {
    diagnostics_.add(errors::channel_bound_twice(*state.channel, place->second));
    return;
  }
  // What a derivative is declared in, else what follows from the state.
  auto const rate = rate_unit(info.unit, state.primes);
  if (state.primes > 0 && unit && rate && unit->dimension != rate->dimension)
    diagnostics_.add(errors::unit_mismatch(state.span, errors::named(primed_name(state.name.text, state.primes)), unit->text,
                                           rate->text_or_dimension()));
  Channel channel;
  channel.name = state.channel->text;
  channel.unit = unit && state.primes > 0 ? unit : rate;
  channel.span = state.channel->span;
  channel.noise.row = find_distribution("normal");  // it is not looked at
  out_.measured.channels.push_back(std::move(channel));
  out_.channel_spans.push_back(state.span);
  out_.numbers.channels.push_back({state.channel->text, index_of(state.name.text), state.primes, {}});
}

DictionaryChecker::StateInfo* DictionaryChecker::find_state(std::string const& name) {
  for (auto& [each, info] : states_)
    if (each == name) return &info;
  return nullptr;
}

int DictionaryChecker::index_of(std::string const& name) const {
  return static_cast<int>(std::find_if(states_.begin(), states_.end(), [&](auto const& each) { return each.first == name; }) -
                          states_.begin());
}

void DictionaryChecker::require_channels() {
  for (auto const& [name, info] : states_)
    if (!info.measured) diagnostics_.add(errors::state_without_channel(info.span, name));
}

void DictionaryChecker::refuse_index(ast::Reference const& reference) {
  std::optional<Diagnostic> sample;
  if (out_.numbers.discrete && reference.index.size() == 1)
    sample = errors::sample_by_index(reference.span, reference.index.front(), {reference.name.text});
  diagnostics_.add(sample ? std::move(*sample) : errors::index_in_dictionary(reference));
}

void DictionaryChecker::find_orders() {
  NamesUsed uses(scope_, [&](ast::Reference const& reference) {
    if (!reference.index.empty()) refuse_index(reference);
    if (StateInfo* state = find_state(reference.name.text)) state->most_primes = std::max(state->most_primes, reference.primes);
    if (reference.primes > 0) primed_.insert(reference.name.text);
  });
  each<ast::DictionaryList>([&](ast::DictionaryList const& list) {
    for (ast::Expression const& item : list.items) uses.of(item);
  });
}

// Every derivative that is mentioned is a leaf of its own; none is solved for.
void DictionaryChecker::lay_out() {
  int first = 0;
  scope_.samples().states = static_cast<int>(states_.size());
  for (std::size_t i = 0; i < states_.size(); ++i) {
    auto& [name, info] = states_[i];
    if (out_.numbers.discrete) {  // as in a model: what is looked for is the state at the present sample
      scope_.find(name)->what = StateSymbol{static_cast<int>(i), 0, static_cast<int>(i)};
      out_.numbers.symbols.push_back({out_.numbers.graph.leaf(LeafKind::unknown, static_cast<int>(i)),
                                      regression::Symbol::Kind::state, static_cast<int>(i), 0});
      out_.numbers.states.push_back(name);
      out_.states.push_back({name, info.unit, info.span});
      continue;
    }
    scope_.find(name)->what = StateSymbol{first, info.most_primes + 1, static_cast<int>(i)};
    for (int k = 0; k <= info.most_primes; ++k)
      out_.numbers.symbols.push_back(
          {out_.numbers.graph.leaf(LeafKind::state, first + k), regression::Symbol::Kind::state, static_cast<int>(i), k});
    first += info.most_primes + 1;
    out_.numbers.states.push_back(name);
    out_.states.push_back({name, info.unit, info.span});
  }
  for (std::size_t i = 0; i < out_.measured.inputs.size(); ++i)
    for (int order = 0; order <= (primed_.contains(out_.measured.inputs[i].name) ? 1 : 0); ++order)
      out_.numbers.symbols.push_back(
          {out_.numbers.graph.leaf(order == 0 ? LeafKind::input : LeafKind::input_rate, static_cast<int>(i)),
           regression::Symbol::Kind::input, static_cast<int>(i), order});
  out_.numbers.symbols.push_back({out_.numbers.graph.leaf(LeafKind::time), regression::Symbol::Kind::time, 0, 0});
}

// Samples further back are leaves as well.
void DictionaryChecker::lay_out_lags() {
  std::vector<NodeId> roots;
  for (regression::Equation const& equation : out_.numbers.equations) {
    roots.push_back(equation.known);
    for (regression::Term const& term : equation.terms) roots.push_back(term.expression);
  }
  Graph& graph = out_.numbers.graph;
  for (NodeId const leaf : graph.reachable(roots)) {
    Node const& node = graph[leaf];
    if (node.operation != Operation::leaf || node.lag == 0) continue;
    regression::Symbol symbol{leaf, regression::Symbol::Kind::time, 0, 0, node.lag};
    if (node.leaf_kind == LeafKind::previous) symbol.kind = regression::Symbol::Kind::state;
    if (node.leaf_kind == LeafKind::input) symbol.kind = regression::Symbol::Kind::input;
    if (symbol.kind != regression::Symbol::Kind::time) symbol.index = node.index;
    out_.numbers.symbols.push_back(symbol);
  }
}

void DictionaryChecker::definitions() {
  each<ast::Definition>([&](ast::Definition const& definition) {
    auto const value = scope_.definition(definition);
    if (value && definition.kind == ast::DefinitionKind::constant && !out_.numbers.graph.constant_value(value->node))
      diagnostics_.add(errors::constant_needed(definition.value.span, {"the value of a constant"}));
  });
}

void DictionaryChecker::values() {
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    ParameterInfo& parameter = parameters_[p];
    if (parameter.tree->prior) {
      parameter.inner = true;
      if (auto made = inner_parameter(parameter, static_cast<int>(p))) out_.inner.push_back(std::move(*made));
      continue;
    }
    if (!parameter.tree->value) {
      free_.insert(parameter.tree->name.name.text);
      continue;
    }
    std::string const& name = parameter.tree->name.name.text;
    auto const value = scope_.expression_in(parameter.unit, parameter.tree->name.name.span, *parameter.tree->value,
                                            {Occasion::Kind::declared, name});
    if (!value) continue;
    parameter.value = out_.numbers.graph.constant_value(adapt(out_.numbers.graph, *value, parameter.unit));
    if (!parameter.value) diagnostics_.add(errors::constant_needed(parameter.tree->value->span, {"the value of a parameter"}));
  }
}

std::optional<InnerParameter> DictionaryChecker::inner_parameter(ParameterInfo const& parameter, int index) {
  Graph& graph = out_.numbers.graph;
  ast::Name const& name = parameter.tree->name.name;
  ast::Call const& prior = *parameter.tree->prior;
  InnerParameter out{{name.text, parameter.unit, name.span}, graph.leaf(LeafKind::parameter, index), {}, {}};
  auto const use = check_distribution(scope_, prior, out.quantity);
  if (!use) return std::nullopt;
  if (use->row->discrete) {
    diagnostics_.add(errors::count_as_prior(prior));
    return std::nullopt;
  }
  if (!use->row->proper || use->row->draw == nullptr) {
    diagnostics_.add(errors::inner_prior(prior.span, name.text, "is improper"));
    return std::nullopt;
  }
  out.prior = use->row;
  bool all = true;
  auto const number = [&](NodeId node) {
    auto const value = graph.constant_value(node);
    all = all && value;
    return value.value_or(0);
  };
  for (NodeId const argument : use->arguments) out.arguments.push_back(number(argument));
  if (use->lower) out.lower = number(*use->lower);
  if (use->upper) out.upper = number(*use->upper);
  if (all) return out;
  diagnostics_.add(errors::inner_prior(prior.span, name.text, "depends on other parameters"));
  return std::nullopt;
}

}  // namespace sysid
