// Passes over declarations: names into the scope, the order of each state from the primes it carries, places of its components.
#include "check/model/model_checker.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "check/expression/discrete_step.hpp"
#include "check/expression/distributions.hpp"
#include "check/expression/names_used.hpp"
#include "check/message/errors.hpp"
#include "check/process/process_expansion.hpp"
#include "check/units/units.hpp"
#include "syntax/walk.hpp"

namespace sysid {

void ModelChecker::declare() {
  for (ast::ModelStatement const& statement : tree_.statements) std::visit([&](auto const& one) { declare_in(one); }, statement);
  for (Scope::ProcessName& process : scope_.processes())
    if (is_expanded(*process.definition)) declare_coefficients(process);
  note_places();
}

void ModelChecker::note_places() {
  struct Places {
    int all = 0, widths = 0;
  };
  std::map<std::string, Places> places;
  for (ast::ModelStatement const& statement : tree_.statements) {
    std::set<std::string> read, elsewhere;
    auto const* observation = std::get_if<ast::Observation>(&statement);
    ast::Expression const* const location = observation == nullptr ? nullptr : location_argument(observation->noise);
    each_top_expression(statement, [&](ast::Expression const& top) {
      each_reference(top, [&](ast::Reference const& reference) {
        read.insert(reference.name.text);
        if (observation == nullptr || location == nullptr || &top == location) elsewhere.insert(reference.name.text);
      });
    });
    for (std::string const& name : read) {
      ++places[name].all;
      if (!elsewhere.contains(name)) ++places[name].widths;
    }
  }
  for (auto const& [name, count] : places) scope_.units().note_places(name, count.all, count.widths == count.all);
}

void ModelChecker::declare_in(ast::TimeDeclaration const& time) {
  if (first_time_ != nullptr) {
    diagnostics_.add(errors::time_twice(time.span, first_time_->span));
    return;
  }
  first_time_ = &time;
  auto const unit = scope_.unit(time.time.unit);
  check_time_unit(unit, time.time.span, diagnostics_);
  scope_.declare(time.time.name, {TimeSymbol{}, unit, time.time.name.span});
}

void ModelChecker::declare_in(ast::DiscreteTimeDeclaration const& discrete) {
  if (first_discrete_ != nullptr) diagnostics_.add(errors::time_twice(discrete.span, first_discrete_->span));
  first_discrete_ = &discrete;
  model_.dynamics = Dynamics::discrete;
  scope_.samples().discrete = true;
  model_.step = declared_step(discrete, scope_);
}

void ModelChecker::declare_in(ast::InputDeclaration const& inputs) {
  for (ast::Declared const& input : inputs.names) {
    auto const unit = scope_.unit(input.unit);
    if (scope_.declare(input.name, {InputSymbol{static_cast<int>(model_.inputs.size())}, unit, input.name.span}))
      model_.inputs.push_back({input.name.text, unit, input.name.span});
  }
}

void ModelChecker::declare_in(ast::StateDeclaration const& states) {
  for (ast::Declared const& state : states.names)
    if (scope_.declare(state.name, {StateSymbol{}, scope_.unit(state.unit), state.name.span}))
      states_.push_back({state.name.text, StateInfo{&state}});
}

void ModelChecker::declare_in(ast::DisturbanceDeclaration const& disturbance) {
  auto unit = scope_.unit(disturbance.name.unit);
  if (unit) unit = difference(*unit);  // it departs from 0
  ast::Name const& name = disturbance.name.name;
  int const index = static_cast<int>(model_.disturbances.size());
  if (!scope_.declare(name, {DisturbanceSymbol{index, -1}, unit, name.span})) return;
  Disturbance declared;
  static_cast<Quantity&>(declared) = {name.text, unit, name.span};
  model_.disturbances.push_back(std::move(declared));
  disturbance_trees_.push_back(&disturbance);
}

void ModelChecker::declare_in(ast::ParameterDeclaration const& parameter) {
  auto const unit = scope_.unit(parameter.name.unit);
  ast::Name const& name = parameter.name.name;
  int const index = static_cast<int>(model_.parameters.size());
  if (!scope_.declare(name, {ParameterSymbol{index}, unit, name.span})) return;
  Parameter declared;
  static_cast<Quantity&>(declared) = {name.text, unit, name.span};
  declared.per_experiment = parameter.name.per_experiment;
  model_.parameters.push_back(std::move(declared));
  parameter_trees_.push_back(&parameter);
}

void ModelChecker::declare_in(ast::Definition const& definition) {
  ast::Name const& name = definition.name.name;
  scope_.declare(name, {DefinitionSymbol{&definition}, scope_.unit(definition.name.unit), name.span});
}

void ModelChecker::declare_in(ast::FunctionDefinition const& function) { scope_.define_function(function); }
void ModelChecker::declare_in(ast::ProcessDefinition const& process) { scope_.define_process(process); }

void ModelChecker::declare_coefficients(Scope::ProcessName& process) {
  ast::Name const& name = process.definition->name;
  auto const taken = std::find_if(model_.parameters.begin(), model_.parameters.end(),
                                  [&](Parameter const& each) { return each.name.starts_with(name.text + "["); });
  if (taken != model_.parameters.end()) {
    diagnostics_.add(errors::duplicate_name(name, taken->span));
    return;
  }
  for (int i = 0, count = coefficient_count(*process.definition); i < count; ++i) {
    Graph& graph = model_.graph;
    Parameter coefficient;
    coefficient.name = fmt::format("{}[{}]", name.text, i + 1);
    coefficient.span = name.span;
    coefficient.prior = Distribution{find_distribution("normal"), {graph.constant(0), graph.constant(1)}, {}, {}};
    coefficient.coefficient = true;
    process.coefficients.push_back(static_cast<int>(model_.parameters.size()));
    model_.parameters.push_back(std::move(coefficient));
  }
}

ModelChecker::StateInfo* ModelChecker::find_state(std::string const& name) {
  for (auto& [each, info] : states_)
    if (each == name) return &info;
  return nullptr;
}

std::size_t ModelChecker::index_of(StateInfo const& info) const {
  return static_cast<std::size_t>(
      std::find_if(states_.begin(), states_.end(), [&](auto const& each) { return &each.second == &info; }) - states_.begin());
}

std::vector<std::string> ModelChecker::state_names() const {
  std::vector<std::string> names;
  for (auto const& [name, info] : states_) names.push_back(name);
  return names;
}

void ModelChecker::find_orders() {
  NamesUsed uses(scope_, [&](ast::Reference const& reference) {
    if (StateInfo* state = find_state(reference.name.text)) state->order = std::max(state->order, reference.primes);
  });
  each<ast::Equation>([&](ast::Equation const& equation) { uses.of(equation); });
}

void ModelChecker::lay_out_states() {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    auto& [name, info] = states_[i];
    Symbol* symbol = scope_.find(name);
    info.first = static_cast<int>(model_.states.size());
    symbol->what = StateSymbol{info.first, info.order, static_cast<int>(i)};
    for (int k = 0; k < info.order; ++k) {
      State component;
      component.name = primed_name(name, k);
      component.unit = rate_unit(symbol->unit, k);
      component.span = info.declaration->name.span;
      model_.states.push_back(std::move(component));
    }
  }
}

}  // namespace sysid
