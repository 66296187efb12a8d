// Initial values: of states, of the past in discrete time, of the search for unknowns; and whether constraints hold there.
#include "check/model/model_checker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "check/expression/distributions.hpp"
#include "check/message/errors.hpp"
#include "check/message/errors_disturbances.hpp"
#include "core/text/free_name.hpp"
#include "model/invariant.hpp"
#include "syntax/walk.hpp"

namespace sysid {

std::optional<ModelChecker::RandomStart> ModelChecker::random_start(ast::Call const& law, Quantity const& state) {
  if (law.function.text != "normal") {
    diagnostics_.add(errors::law_of_initial(law, state.name));
    return std::nullopt;
  }
  auto const use = check_distribution(scope_, law, state);
  if (!use) return std::nullopt;
  if (use->lower || use->upper) {
    diagnostics_.add(errors::bounds_of_initial(law, state.name));
    return std::nullopt;
  }
  for (NodeId const argument : use->arguments)
    if (!moving_part(model_.graph, argument).empty()) {
      diagnostics_.add(errors::initial_moves(law.span));
      return std::nullopt;
    }
  initial_laws_.emplace_back(*use, state);
  return RandomStart{use->arguments[0], model_.graph.multiply(use->arguments[1], use->arguments[1])};
}

void ModelChecker::initial_lags() {
  initial_lags_.resize(states_.size());
  initial_lag_variances_.resize(states_.size());
  std::map<std::string, Span> given;
  each<ast::InitialDeclaration>([&](ast::InitialDeclaration const& declaration) {
    for (ast::InitialValue const& initial : declaration.values) {
      auto const place =
          std::find_if(states_.begin(), states_.end(), [&](auto const& state) { return state.first == initial.state.name.text; });
      if (place == states_.end()) {
        diagnostics_.add(errors::not_a_state(initial.state.name, state_names()));
        continue;
      }
      if (initial.state.primes > 0) {
        diagnostics_.add(errors::primes_in_discrete_time(initial.state));
        continue;
      }
      if (auto const [first, fresh] = given.emplace(place->first, initial.span); !fresh) {
        diagnostics_.add(errors::initial_twice(initial.span, first->second, place->first));
        continue;
      }
      Symbol const& state = *scope_.find(place->first);
      auto const index = static_cast<std::size_t>(place - states_.begin());
      if (initial.law) {
        if (auto const random = random_start(*initial.law, {place->first, state.unit, state.span})) {
          initial_lags_[index] = random->mean;
          initial_lag_variances_[index] = random->variance;
        }
        continue;
      }
      auto const value = scope_.expression_in(state.unit, state.span, *initial.value, {Occasion::Kind::declared, place->first});
      if (!value) continue;
      bool const moves = model_.graph.depends(value->node, [](Node const& node) {
        return node.operation == Operation::leaf && node.leaf_kind != LeafKind::parameter &&
               !(node.leaf_kind == LeafKind::measured && node.lag == 0);
      });
      if (moves) {
        diagnostics_.add(errors::initial_moves(initial.value->span));
        continue;
      }
      initial_lags_[index] = adapt(model_.graph, *value, state.unit);
    }
  });
}

errors::StartValue ModelChecker::start_of_temperature(State const& state, std::set<std::string> const& read) const {
  Unit kelvin;
  kelvin.dimension[4] = {1, 1};
  Unit const unit = state.unit.value_or(Unit{});
  bool const counts_from_zero_point = unit.offset != 0;
  // Of a difference 0 is usual. Its units differ from those of temperatures by their names alone.
  if (unit.dimension != kelvin.dimension || unit.text.find("delta_") != std::string::npos) return {"0"};
  std::string const name =
      free_name(state.name.substr(0, state.name.find_first_of("[.")) + "_start",
                [&](std::string const& taken) { return read.contains(taken) || scope_.find(taken) != nullptr; });
  double const typical = counts_from_zero_point ? convert(293.15, kelvin, unit) : 300 / unit.scale;
  double const spread = (counts_from_zero_point ? 20 : 30) / unit.scale;
  return {name, fmt::format("parameter {} [{}] ~ normal({:.3g}, sd = {:.3g})", name, unit.text, typical, spread),
          !counts_from_zero_point};
}

std::vector<errors::StartValue> ModelChecker::values_to_give(std::vector<std::size_t> const& components) const {
  std::set<std::string> read;
  for (ast::ModelStatement const& statement : tree_.statements)
    each_reference(statement, [&](ast::Reference const& reference) { read.insert(reference.name.text); });
  auto const same_kind = [](std::optional<Unit> const& a, std::optional<Unit> const& b) {
    Unit const left = a.value_or(Unit{}), right = b.value_or(Unit{});
    return left.dimension == right.dimension && left.offset == right.offset;
  };
  std::vector<errors::StartValue> values;
  for (std::size_t const component : components) {
    State const& state = model_.states[component];
    std::vector<std::string> unused, alike;
    for (Parameter const& each : model_.parameters) {
      if (read.contains(each.name) || !same_kind(each.unit, state.unit)) continue;
      unused.push_back(each.name);
      if (each.name.starts_with(state.name)) alike.push_back(each.name);
    }
    if (alike.size() == 1) unused = alike;
    bool const taken = unused.size() == 1 && std::any_of(values.begin(), values.end(), [&](errors::StartValue const& each) {
                         return each.value == unused.front();
                       });
    values.push_back(unused.size() == 1 && !taken ? errors::StartValue{unused.front()} : start_of_temperature(state, read));
  }
  return values;
}

std::vector<std::string> ModelChecker::without_initial() const {
  std::set<std::string> given;
  for (ast::ModelStatement const& statement : tree_.statements)
    if (auto const* declaration = std::get_if<ast::InitialDeclaration>(&statement))
      for (ast::InitialValue const& initial : declaration->values)
        given.insert(primed_name(initial.state.name.text, initial.state.primes));
  std::vector<std::string> missing;
  for (State const& state : model_.states)
    if (!given.contains(state.name)) missing.push_back(state.name);
  return missing;
}

void ModelChecker::initial_values() {
  if (scope_.samples().discrete) {
    initial_lags();
    return;
  }
  std::map<int, Span> given;
  bool misnamed = false;  // what is missing then may be meant by the wrong name
  each<ast::InitialDeclaration>([&](ast::InitialDeclaration const& declaration) {
    for (ast::InitialValue const& initial : declaration.values) {
      StateInfo const* info = find_state(initial.state.name.text);
      if (info == nullptr) {
        misnamed = true;
        Symbol const* const symbol = scope_.find(initial.state.name.text);
        bool const input = symbol != nullptr && std::holds_alternative<InputSymbol>(symbol->what);
        diagnostics_.add(input ? errors::initial_of_input(initial.state.name)
                               : errors::not_a_state(initial.state.name, state_names(), without_initial()));
        continue;
      }
      if (info->order == 0 && model_.unknowns.empty()) continue;  // reported with the equations
      if (initial.state.primes == info->order && (info->order == 0 || model_.implicit)) {
        guess(initial, model_.unknowns[index_of(*info)]);
        continue;
      }
      if (initial.state.primes >= info->order) {
        if (orders_doubtful_) continue;
        // One too high and one missing are one mistake.
        std::vector<std::string> const lacking = without_initial();
        misnamed = misnamed || lacking.size() == 1;
        diagnostics_.add(errors::initial_of_highest(initial.state, initial.state.name.text, info->order, lacking));
        continue;
      }
      int const component = info->first + initial.state.primes;
      State& state = model_.states[static_cast<std::size_t>(component)];
      if (auto const [place, fresh] = given.emplace(component, initial.span); !fresh) {
        diagnostics_.add(errors::initial_twice(initial.span, place->second, state.name));
        continue;
      }
      if (initial.law) {
        auto const random = random_start(*initial.law, state);
        if (!random) continue;
        state.initial = random->mean;
        state.initial_variance = random->variance;
        state.initial_given = true;
        continue;
      }
      auto const* word = std::get_if<ast::Reference>(&initial.value->node);
      if (word != nullptr && scope_.find(word->name.text) == nullptr && scope_.samples().channels.contains(word->name.text)) {
        diagnostics_.add(errors::initial_from_channel(word->name, initial.state, state.unit));
        continue;
      }
      auto const value = scope_.expression_in(state.unit, state.span, *initial.value, {Occasion::Kind::declared, state.name});
      if (!value) continue;
      if (!moving_part(model_.graph, value->node).empty()) {
        diagnostics_.add(errors::initial_moves(initial.value->span));
        continue;
      }
      state.initial = adapt(model_.graph, *value, state.unit);
      state.initial_given = true;
    }
  });
  for (std::size_t i = 0; i < model_.states.size() && !orders_doubtful_;) {
    Span const declaration = model_.states[i].span;
    std::vector<std::string> missing;
    std::vector<std::size_t> components;
    for (; i < model_.states.size() && model_.states[i].span == declaration; ++i) {
      if (given.contains(static_cast<int>(i)) || model_.states[i].initial_given) continue;
      missing.push_back(model_.states[i].name);
      components.push_back(i);
    }
    if (!missing.empty() && !misnamed) diagnostics_.add(errors::initial_missing(declaration, missing, values_to_give(components)));
  }
}

void ModelChecker::guess(ast::InitialValue const& initial, Unknown& unknown) {
  if (initial.law) {
    diagnostics_.add(errors::random_guess(initial.span, unknown.name));
    return;
  }
  auto const value = scope_.expression_in(unknown.unit, unknown.span, *initial.value, {Occasion::Kind::declared, unknown.name});
  if (!value) return;
  if (!moving_part(model_.graph, value->node).empty()) {
    diagnostics_.add(errors::initial_moves(initial.value->span));
    return;
  }
  unknown.guess = adapt(model_.graph, *value, unknown.unit);
  if (!model_.implicit)
    given_unknowns_.push_back({static_cast<std::size_t>(&unknown - model_.unknowns.data()), unknown.guess, initial.span});
}

void ModelChecker::unused_starts(std::vector<NodeId> const& initial) {
  if (given_unknowns_.empty()) return;
  Model copy = model_;  // need not hold the nodes of a question
  Graph& graph = copy.graph;
  for (GivenUnknown const& each : given_unknowns_) {
    if (graph.is_constant(each.value, 0)) continue;  // stands for no value
    NodeId const difference = graph.subtract(each.value, highest_[each.unknown]);
    // Which branch it is on depends on the parameters.
    auto const branches = [](Node const& node) {
      return node.operation == Operation::select || node.operation == Operation::minimum || node.operation == Operation::maximum;
    };
    if (graph.depends(difference, branches)) continue;
    constexpr double rounded = 1e-3;  // it is written with a few digits
    if (violated_at_start(copy, {difference, constraint_size(graph, difference), each.span}, initial, rounded))
      diagnostics_.add(errors::start_not_used(each.span, model_.unknowns[each.unknown].name));
  }
}

void ModelChecker::constraints() {
  std::optional<Span> given;
  each<ast::InitialDeclaration>([&](ast::InitialDeclaration const& declaration) { given = given.value_or(declaration.span); });
  std::vector<NodeId> initial;
  for (State const& state : model_.states) initial.push_back(state.initial);
  unused_starts(initial);
  std::set<std::size_t> seen;
  for (Invariant const& constraint : constraints_) {
    bool const original = seen.insert(constraint.span.begin).second;
    if (original) model_.invariants.push_back(constraint);
    if (given && violated_at_start(model_, constraint, initial)) {
      diagnostics_.add(errors::start_off_constraint(constraint.span, *given));
      return;
    }
  }
}

}  // namespace sysid
