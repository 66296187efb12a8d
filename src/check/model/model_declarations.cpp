// Passes over declarations: names into the scope, the order of each state from the primes it carries, places of its components.
#include "check/model/model_checker.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "check/expression/discrete_step.hpp"
#include "check/expression/names_used.hpp"
#include "check/message/errors.hpp"
#include "check/process/process_expansion.hpp"
#include "check/units/units.hpp"

namespace sysid {

void ModelChecker::declare() {
  ast::TimeDeclaration const* first_time = nullptr;
  ast::DiscreteTimeDeclaration const* first_discrete = nullptr;
  for (ast::ModelStatement const& statement : tree_.statements) {
    if (auto const* time = std::get_if<ast::TimeDeclaration>(&statement)) {
      if (first_time != nullptr) {
        diagnostics_.add(errors::time_twice(time->span, first_time->span));
        continue;
      }
      first_time = time;
      auto const unit = scope_.unit(time->time.unit);
      check_time_unit(unit, time->time.span, diagnostics_);
      scope_.declare(time->time.name, {TimeSymbol{}, unit, time->time.name.span});
    } else if (auto const* discrete = std::get_if<ast::DiscreteTimeDeclaration>(&statement)) {
      if (first_discrete != nullptr) diagnostics_.add(errors::time_twice(discrete->span, first_discrete->span));
      first_discrete = discrete;
      declare_step(*discrete);
    } else if (auto const* inputs = std::get_if<ast::InputDeclaration>(&statement)) {
      for (ast::Declared const& input : inputs->names) {
        auto const unit = scope_.unit(input.unit);
        if (scope_.declare(input.name, {InputSymbol{static_cast<int>(model_.inputs.size())}, unit, input.name.span}))
          model_.inputs.push_back({input.name.text, unit, input.name.span});
      }
    } else if (auto const* states = std::get_if<ast::StateDeclaration>(&statement)) {
      for (ast::Declared const& state : states->names)
        if (scope_.declare(state.name, {StateSymbol{}, scope_.unit(state.unit), state.name.span}))
          states_.push_back({state.name.text, StateInfo{&state}});
    } else if (auto const* disturbance = std::get_if<ast::DisturbanceDeclaration>(&statement)) {
      auto unit = scope_.unit(disturbance->name.unit);
      if (unit) unit = difference(*unit);  // it departs from 0
      int const index = static_cast<int>(model_.disturbances.size());
      if (scope_.declare(disturbance->name.name, {DisturbanceSymbol{index, -1}, unit, disturbance->name.name.span})) {
        Disturbance declared;
        static_cast<Quantity&>(declared) = {disturbance->name.name.text, unit, disturbance->name.name.span};
        model_.disturbances.push_back(std::move(declared));
        disturbance_trees_.push_back(disturbance);
      }
    } else if (auto const* parameter = std::get_if<ast::ParameterDeclaration>(&statement)) {
      auto const unit = scope_.unit(parameter->name.unit);
      int const index = static_cast<int>(model_.parameters.size());
      if (scope_.declare(parameter->name.name, {ParameterSymbol{index}, unit, parameter->name.name.span})) {
        Parameter declared;
        declared.name = parameter->name.name.text;
        declared.unit = unit;
        declared.span = parameter->name.name.span;
        declared.per_experiment = parameter->name.per_experiment;
        model_.parameters.push_back(std::move(declared));
        parameter_trees_.push_back(parameter);
      }
    } else if (auto const* definition = std::get_if<ast::Definition>(&statement)) {
      scope_.declare(definition->name.name,
                     {DefinitionSymbol{definition}, scope_.unit(definition->name.unit), definition->name.name.span});
    } else if (auto const* function = std::get_if<ast::FunctionDefinition>(&statement)) {
      scope_.define_function(*function);
    } else if (auto const* process = std::get_if<ast::ProcessDefinition>(&statement)) {
      scope_.define_process(*process);
    }
  }
  for (Scope::ProcessName& process : scope_.processes()) {
    if (auto const taken =
            std::find_if(model_.parameters.begin(), model_.parameters.end(),
                         [&](Parameter const& each) { return each.name.starts_with(process.definition->name.text + "["); });
        is_expanded(*process.definition) && taken != model_.parameters.end()) {
      diagnostics_.add(errors::duplicate_name(process.definition->name, taken->span));
      continue;
    }
    for (int i = 0, count = is_expanded(*process.definition) ? coefficient_count(*process.definition) : 0; i < count; ++i) {
      Graph& graph = model_.graph;
      Parameter coefficient;
      coefficient.name = fmt::format("{}[{}]", process.definition->name.text, i + 1);
      coefficient.span = process.definition->name.span;
      coefficient.prior = Distribution{find_distribution("normal"), {graph.constant(0), graph.constant(1)}, {}, {}};
      coefficient.coefficient = true;
      process.coefficients.push_back(static_cast<int>(model_.parameters.size()));
      model_.parameters.push_back(std::move(coefficient));
    }
  }
}

void ModelChecker::declare_step(ast::DiscreteTimeDeclaration const& discrete) {
  model_.dynamics = Dynamics::discrete;
  scope_.samples().discrete = true;
  model_.step = declared_step(discrete, scope_);
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
