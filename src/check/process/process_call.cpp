// A Gaussian process where it is applied: its arguments, and its declaration with the units that they bring.
#include <algorithm>
#include <utility>

#include "check/expression/leaves.hpp"
#include "check/expression/scope.hpp"
#include "check/message/errors.hpp"
#include "check/process/process_conditions.hpp"
#include "check/process/process_covariance.hpp"
#include "check/process/process_expansion.hpp"
#include "check/process/process_units.hpp"
#include "check/units/units.hpp"

namespace sysid {

bool Scope::define_process(ast::ProcessDefinition const& process) {
  for (ProcessName const& each : processes_)
    if (each.definition->name.text == process.name.text) {
      diagnostics_.add(errors::duplicate_name(process.name, each.definition->name.span));
      return false;
    }
  if (auto const place = functions_.find(process.name.text); place != functions_.end()) {
    diagnostics_.add(errors::duplicate_name(process.name, place->second->name.span));
    return false;
  }
  // Finite sums last: leaves count the others.
  auto const place = is_expanded(process) ? processes_.end()
                                          : std::find_if(processes_.begin(), processes_.end(),
                                                         [](ProcessName const& each) { return is_expanded(*each.definition); });
  processes_.insert(place, {&process, {}, {}, {}, {}});
  return true;
}

std::optional<ProcessArguments> Scope::process_declaration(ast::ProcessDefinition const& definition,
                                                           std::vector<std::vector<int>> const& columns,
                                                           std::vector<std::optional<Unit>> const& units, Process& process) {
  auto const* outer = std::exchange(arguments_, nullptr);
  auto calls = units_.suspend();
  HyperParametersGiven given;
  auto arguments = process_arguments(definition, {"zero_at", "flat_at", "within", "terms"}, diagnostics_);
  if (arguments && !(read_covariance(*this, definition, *arguments->covariance, columns, process, given) &&
                     resolve_units(*this, definition, given, units, process) &&
                     read_conditions(*this, definition, *arguments, columns, process)))
    arguments.reset();
  units_.resume(std::move(calls));
  arguments_ = outer;
  return arguments;
}

std::optional<Typed> Scope::process_call(ast::Call const& call, std::size_t index) {
  ast::ProcessDefinition const& definition = *processes_[index].definition;
  std::string const& name = definition.name.text;
  bool const expanded = is_expanded(definition);
  if (samples_.in_equation && !samples_.discrete && !expanded) {
    diagnostics_.add(errors::process_in_differential_equation(call.span, name));
    return std::nullopt;
  }
  if (call.arguments.size() != definition.inputs.size()) {
    diagnostics_.add(
        errors::argument_count(call.function, call.arguments.size(), definition.inputs.size(), definition.inputs.size()));
    return std::nullopt;
  }
  Process process;
  process.name = name;
  process.span = definition.name.span;
  std::vector<std::vector<int>> columns;
  std::vector<std::optional<Unit>> units;
  std::vector<Typed> given;
  bool good = true;
  for (std::size_t i = 0; i < call.arguments.size(); ++i) {
    ast::Argument const& argument = call.arguments[i];
    if (argument.name) {
      diagnostics_.add(errors::named_argument_of_function(*argument.name, name));
      return std::nullopt;
    }
    std::vector<Typed> values;
    int lag = -1;
    auto const* inner = std::get_if<ast::Box<ast::Call>>(&argument.value.node);
    if (inner != nullptr && (*inner)->function.text == "lags" && is_lag_call(**inner)) {
      if (auto lags = lag_calls(**inner)) {
        values = std::move(lags->values);
        lag = lags->first;
      }
    } else if (auto const value = expression(argument.value)) {
      values.push_back(with_own_unit(*value));
    }
    good = good && !values.empty();
    columns.emplace_back();
    for (Typed const& value : values) {
      columns.back().push_back(static_cast<int>(process.inputs.size()));
      process.inputs.push_back({definition.inputs[i].text, known_unit(value), argument.span});
      process.arguments.push_back(value.node);
      process.lags.push_back(lag < 0 ? -1 : lag++);
      given.push_back(value);
      units.push_back(known_unit(value));
      if (units.back()) units.back() = difference(*units.back());
    }
  }
  if (!good) return std::nullopt;
  for (NodeId const argument : process.arguments)
    if (graph_.depends(argument, [](Node const& node) { return is_leaf(node, LeafKind::process); })) {
      diagnostics_.add(errors::process_out_of_place(call.span, "in the arguments of a Gaussian process"));
      return std::nullopt;
    }
  if (expanded) return expansion_call(call, index, columns, given, std::move(process));
  NodeId const leaf = graph_.leaf(LeafKind::process, static_cast<int>(index));
  if (processes_[index].use) {
    if (processes_[index].use->arguments != process.arguments) {
      diagnostics_.add(errors::process_applied_twice(call.span, processes_[index].call, name));
      return std::nullopt;
    }
    return with_unit(leaf, processes_[index].use->unit, call.span);
  }
  if (!process_declaration(definition, columns, units, process)) return std::nullopt;
  Typed const value = with_unit(leaf, process.unit, call.span);
  processes_[index].use = std::move(process);
  processes_[index].call = call.span;
  return value;
}

std::optional<Typed> Scope::expansion_call(ast::Call const& call, std::size_t index, std::vector<std::vector<int>> const& columns,
                                           std::vector<Typed> const& given, Process process) {
  ProcessName& known = processes_[index];
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].size() != 1) {
      diagnostics_.add(errors::expansion_of_lags(call.arguments[i].span, known.definition->name.text));
      return std::nullopt;
    }
  process.arguments.clear();
  if (!known.expansion) {
    std::vector<std::optional<Unit>> units;
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (given[i].kind == Typed::Kind::literal) {
        diagnostics_.add(errors::expansion_of_number(call.arguments[i].span, known.definition->name.text));
        return std::nullopt;
      }
      units.push_back(known_unit(given[i]));
      if (units.back()) units.back() = difference(*units.back());
    }
    auto const declared = process_declaration(*known.definition, columns, units, process);
    if (!declared) return std::nullopt;
    auto const* outer = std::exchange(arguments_, nullptr);
    known.expansion = expand(*this, *known.definition, *declared, std::move(process), known.coefficients);
    arguments_ = outer;
    if (!known.expansion) return std::nullopt;
    known.call = call.span;
  }
  std::vector<NodeId> arguments;
  for (std::size_t i = 0; i < given.size(); ++i) {
    auto const &wanted = known.expansion->inputs[i].unit, unit = known_unit(given[i]);
    if (wanted && unit && wanted->dimension != unit->dimension) {
      diagnostics_.add(errors::expansion_unit(call.arguments[i].span, known.definition->name.text, *unit, *wanted));
      return std::nullopt;
    }
    arguments.push_back(adapt(graph_, given[i], wanted));
  }
  known.expansion->applications.push_back(arguments);
  NodeId const value = graph_.substitute(known.expansion->value, [&](NodeId leaf) -> std::optional<NodeId> {
    Node const node = graph_[leaf];
    if (node.leaf_kind != LeafKind::unknown || node.index >= 0) return std::nullopt;
    return arguments[static_cast<std::size_t>(-1 - node.index)];
  });
  return with_unit(value, known.expansion->unit, call.span);
}

}  // namespace sysid
