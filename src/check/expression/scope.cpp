// Names to nodes: states become leaves of the first-order system, definitions are expanded in place.
#include "check/expression/scope.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

#include "check/message/errors.hpp"
#include "check/message/errors_disturbances.hpp"
#include "check/units/units.hpp"
#include "syntax/walk.hpp"

namespace sysid {

std::string primed_name(std::string const& name, int primes) { return name + std::string(static_cast<std::size_t>(primes), '\''); }

std::optional<Unit> rate_unit(std::optional<Unit> const& unit, int primes) {
  if (!unit || primes == 0) return unit;
  Unit second;
  second.dimension[2] = {1, 1};
  Unit result = divide(*unit, power(second, {primes, 1}));
  std::string const base = unit->text == "-" ? "1" : unit->text;
  if (!base.empty()) result.text = base + (primes == 1 ? "/s" : "/s^" + std::to_string(primes));
  return result;
}

Scope::Scope(Graph& graph, Diagnostics& diagnostics, std::vector<ast::FunctionDefinition const*> shared_functions)
    : graph_(graph), diagnostics_(diagnostics), units_(graph, diagnostics) {
  for (auto const* function : shared_functions) functions_.emplace(function->name.text, function);
}

namespace {

DeclaredRole role_of(Symbol const& symbol) {
  using Kind = DeclaredRole::Kind;
  if (std::holds_alternative<ParameterSymbol>(symbol.what)) return {Kind::fixed, {}};
  auto const* known = std::get_if<DefinitionSymbol>(&symbol.what);
  if (known == nullptr) return {Kind::varying, {}};
  DeclaredRole role{Kind::local, {}};
  if (known->definition->kind == ast::DefinitionKind::constant) role.kind = Kind::constant;
  if (known->definition->kind == ast::DefinitionKind::derived) role.kind = Kind::reported;
  each_reference(known->definition->value, [&](ast::Reference const& read) { role.reads.push_back(read.name.text); });
  return role;
}

}  // namespace

bool Scope::declare(ast::Name const& name, Symbol symbol) {
  auto const [place, fresh] = symbols_.emplace(name.text, std::move(symbol));
  Symbol const& declared = place->second;
  if (fresh) units_.declare(name.text, role_of(declared));
  if (fresh && declared.unit) {
    bool const moves = std::holds_alternative<StateSymbol>(declared.what) || std::holds_alternative<InputSymbol>(declared.what);
    units_.declare({name.text, *declared.unit, moves});
  }
  if (!fresh) diagnostics_.add(errors::duplicate_name(name, place->second.span));
  return fresh;
}

bool Scope::define_function(ast::FunctionDefinition const& function) {
  auto const [place, fresh] = functions_.emplace(function.name.text, &function);
  if (!fresh) diagnostics_.add(errors::duplicate_name(function.name, place->second->name.span));
  return fresh;
}

Symbol const* Scope::find(std::string const& name) const {
  auto const place = symbols_.find(name);
  return place == symbols_.end() ? nullptr : &place->second;
}
Symbol* Scope::find(std::string const& name) {
  auto const place = symbols_.find(name);
  return place == symbols_.end() ? nullptr : &place->second;
}

ast::FunctionDefinition const* Scope::find_function_definition(std::string const& name) const {
  auto const place = functions_.find(name);
  return place == functions_.end() ? nullptr : place->second;
}

std::vector<std::string> Scope::names() const {
  std::vector<std::string> names;
  for (auto const& [name, symbol] : symbols_) names.push_back(name);
  if (arguments_)
    for (auto const& [name, value] : *arguments_) names.push_back(name);
  return names;
}

std::vector<std::string> Scope::moving_names() const {
  std::vector<std::string> names;
  for (auto const& [name, symbol] : symbols_)
    if (std::holds_alternative<StateSymbol>(symbol.what) || std::holds_alternative<InputSymbol>(symbol.what)) names.push_back(name);
  return names;
}

std::optional<Unit> Scope::unit_of(ast::Definition const& definition) const {
  Symbol const* symbol = find(definition.name.name.text);
  auto const* known = symbol == nullptr ? nullptr : std::get_if<DefinitionSymbol>(&symbol->what);
  if (known != nullptr && known->definition == &definition) return symbol->unit;
  Diagnostics said_when_declared;
  return check_unit(definition.name.unit, said_when_declared);
}

std::optional<Typed> Scope::definition(ast::Definition const& definition) {
  if (auto const known = resolved_.find(&definition); known != resolved_.end()) return known->second;
  std::string const& name = definition.name.name.text;
  if (auto const begin = std::find(resolving_.begin(), resolving_.end(), name); begin != resolving_.end()) {
    std::vector<std::string> loop(begin, resolving_.end());
    loop.push_back(name);
    diagnostics_.add(errors::definition_cycle(definition.name.span, loop));
    return resolved_[&definition] = std::nullopt;
  }
  resolving_.push_back(name);
  auto const* outer = std::exchange(arguments_, nullptr);
  auto calls = units_.suspend();
  std::optional<Unit> const unit = unit_of(definition);
  std::optional<Typed> value = expression_in(unit, definition.name.name.span, definition.value, {Occasion::Kind::declared, name});
  units_.resume(std::move(calls));
  arguments_ = outer;
  resolving_.pop_back();
  if (auto const known = resolved_.find(&definition); known != resolved_.end()) return known->second;  // a loop through itself
  if (value && unit) {
    value->node = adapt(graph_, *value, unit);
    value->kind = Typed::Kind::known;
    value->unit = *unit;
    value->turns = 0;
  } else if (value && value->kind == Typed::Kind::literal) {
    value->kind = Typed::Kind::unknown;  // a named number is no longer a literal that adapts
  }
  if (value) *value = with_own_unit(*value);
  return resolved_[&definition] = value;
}

std::optional<Typed> Scope::reference(ast::Reference const& reference) {
  std::string const& name = reference.name.text;
  Span const span = reference.span;
  if (arguments_) {
    if (auto const argument = arguments_->find(name); argument != arguments_->end()) {
      if (reference.primes > 0) {
        diagnostics_.add(errors::primes_on(reference, "an argument of this function"));
        return std::nullopt;
      }
      Typed value = argument->second;
      value.span = span;
      return value;
    }
  }
  Symbol const* symbol = find(name);
  if (symbol == nullptr) {
    if (reference.primes == 0) {
      if (name == "pi") return literal(graph_, std::numbers::pi, span);
      if (name == "inf") return literal(graph_, std::numeric_limits<double>::infinity(), span);
    }
    diagnostics_.add(samples_.channels.contains(name)
                         ? errors::channel_as_quantity(reference.name, samples_.discrete, fmt::format("lag(measured({}), 1)", name))
                         : errors::unknown_name(reference.name, names(), moving_names()));
    return std::nullopt;
  }
  auto const no_primes = [&](std::string const& what) {
    if (reference.primes == 0) return true;
    diagnostics_.add(errors::primes_on(reference, what));
    return false;
  };
  if (samples_.discrete && reference.primes > 0) {
    diagnostics_.add(errors::primes_in_discrete_time(reference));
    return std::nullopt;
  }
  if (auto const* state = std::get_if<StateSymbol>(&symbol->what)) {
    // The order of a state is the most primes its name carries anywhere in an equation, so `observe` may not ask for more.
    if (state->order == 0 && reference.primes > 0) return std::nullopt;  // a state without an equation: said there
    if (reference.primes > state->order) {
      diagnostics_.add(errors::beyond_highest(reference, state->order));
      return std::nullopt;
    }
    NodeId const node = reference.primes == state->order ? graph_.leaf(LeafKind::unknown, state->unknown)
                                                         : graph_.leaf(LeafKind::state, state->first + reference.primes);
    return with_unit(node, rate_unit(symbol->unit, reference.primes), span);
  }
  if (auto const* input = std::get_if<InputSymbol>(&symbol->what)) {
    if (reference.primes > 1) {
      diagnostics_.add(errors::second_input_derivative(reference));
      return std::nullopt;
    }
    NodeId const node = graph_.leaf(reference.primes == 0 ? LeafKind::input : LeafKind::input_rate, input->index);
    graph_.set_span(node, span);
    return with_unit(node, rate_unit(symbol->unit, reference.primes), span);
  }
  if (auto const* disturbance = std::get_if<DisturbanceSymbol>(&symbol->what)) {
    if (reference.primes > 0) {
      diagnostics_.add(errors::rate_of_disturbance(reference));
      return std::nullopt;
    }
    NodeId const node = disturbance->state >= 0 ? graph_.leaf(LeafKind::state, disturbance->state)
                                                : graph_.leaf(LeafKind::disturbance, disturbance->index);
    graph_.set_span(node, span);
    return with_unit(node, symbol->unit, span);
  }
  if (auto const* parameter = std::get_if<ParameterSymbol>(&symbol->what))
    return no_primes("a parameter")
               ? std::optional(with_unit(graph_.leaf(LeafKind::parameter, parameter->index), symbol->unit, span))
               : std::nullopt;
  if (std::holds_alternative<TimeSymbol>(symbol->what))
    return no_primes("time") ? std::optional(with_unit(graph_.leaf(LeafKind::time), symbol->unit, span)) : std::nullopt;
  auto const& definition_symbol = std::get<DefinitionSymbol>(symbol->what);
  if (!no_primes("a definition")) return std::nullopt;
  auto value = definition(*definition_symbol.definition);
  if (value) value->span = span;
  return value;
}

}  // namespace sysid
