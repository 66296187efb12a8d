// Arguments of a distribution are matched to rows of its table; scales must be spelt out (sd, variance or precision).
#include "check/expression/distributions.hpp"

#include <cmath>

#include "check/message/errors.hpp"
#include "check/message/unit_words.hpp"

namespace sysid {
namespace {

std::vector<std::string> spelling_names(ArgumentRow const& row) {
  std::vector<std::string> names;
  for (Spelling const& spelling : row.spellings) names.emplace_back(spelling.name);
  return names;
}

struct Given {
  ast::Expression const* value = nullptr;
  Spelling const* spelling = nullptr;
  Span span;
};

std::optional<Unit> unit_of_argument(std::optional<Unit> const& unit, int unit_power) {
  if (!unit) return unit_power == 0 ? std::optional(Unit{}) : std::nullopt;
  return unit_power == 1 ? unit : power(*unit, {unit_power, 1});
}

}  // namespace

ast::Expression const* location_argument(ast::Call const& call) {
  for (ast::Argument const& argument : call.arguments)
    if (!argument.name || argument.name->text == "mean" || argument.name->text == "median" || argument.name->text == "location")
      return &argument.value;
  return nullptr;
}

std::optional<Distribution> check_distribution(Scope& scope, ast::Call const& call, Quantity const& variate) {
  Diagnostics& diagnostics = scope.diagnostics();
  std::optional<Unit> const& unit = variate.unit;
  DistributionRow const* row = find_distribution(call.function.text);
  if (row == nullptr) {
    std::vector<std::string> known;
    for (DistributionRow const& each : distributions()) known.emplace_back(each.name);
    diagnostics.add(errors::unknown_distribution(call.function, known));
    return std::nullopt;
  }
  std::string const name(row->name);
  std::vector<std::string> signature;
  for (ArgumentRow const& argument : row->arguments)
    for (auto const& spelling : spelling_names(argument)) signature.push_back(spelling);

  bool good = true;
  std::vector<Given> given(row->arguments.size());
  Given lower, upper;
  std::size_t position = 0;
  auto const take = [&](Given& place, Spelling const* spelling, ast::Argument const& argument, std::string const& spelt) {
    if (place.value != nullptr) {
      diagnostics.add(
          errors::argument_twice(argument.span, place.span, spelt, place.spelling ? std::string(place.spelling->name) : spelt));
      good = false;
      return;
    }
    place = {&argument.value, spelling, argument.span};
  };
  for (ast::Argument const& argument : call.arguments) {
    if (!argument.name) {
      if (position >= given.size()) {
        diagnostics.add(errors::too_many_arguments(argument.span, name, signature));
        good = false;
      } else if (row->arguments[position].spellings.size() > 1) {
        diagnostics.add(errors::must_be_named(argument.span, name, spelling_names(row->arguments[position])));
        good = false;
        ++position;
      } else {
        Spelling const& spelling = row->arguments[position].spellings.front();
        take(given[position], &spelling, argument, std::string(spelling.name));
        ++position;
      }
      continue;
    }
    std::string const& key = argument.name->text;
    bool found = false;
    for (std::size_t i = 0; i < given.size() && !found; ++i)
      for (Spelling const& spelling : row->arguments[i].spellings)
        if (spelling.name == key) {
          take(given[i], &spelling, argument, key);
          found = true;
          break;
        }
    if (!found && (key == "lower" || key == "upper")) {
      if (row->cumulative == nullptr) {
        diagnostics.add(errors::cannot_truncate(argument.span, name));
        good = false;
      }
      take(key == "lower" ? lower : upper, nullptr, argument, key);
      found = true;
    }
    if (!found) {
      std::vector<std::string> known = signature;
      if (row->cumulative != nullptr) known.insert(known.end(), {"lower", "upper"});
      diagnostics.add(errors::unknown_argument(*argument.name, name, known));
      good = false;
    }
  }

  Distribution use;
  use.row = row;
  Graph& graph = scope.graph();
  std::string const declared = unit ? "[" + unit_words(*unit, {}) + "]" : "";
  auto const argument_in = [&](std::optional<Unit> const& wanted, ast::Expression const& tree, std::string const& spelt,
                               bool is_width = false) {
    return scope.expression_in(wanted, variate.span, tree, {Occasion::Kind::distribution, spelt, variate.name, declared, is_width});
  };
  bool all_given = good;
  for (std::size_t i = 0; i < given.size(); ++i) {
    ArgumentRow const& argument = row->arguments[i];
    if (given[i].value == nullptr) {
      if (std::isnan(argument.fallback)) {
        if (all_given) diagnostics.add(errors::argument_missing(call, spelling_names(argument)));
        good = false;
      } else {
        int const unit_power = argument.spellings.front().unit_power;
        auto const scale = unit_of_argument(unit, unit_power);
        use.arguments.push_back(graph.constant(argument.fallback * (scale ? scale->scale : 1)));
      }
      continue;
    }
    std::optional<Unit> argument_unit = unit_of_argument(unit, given[i].spelling->unit_power);
    // Widths of a temperature are differences: they have no zero to shift.
    std::string_view const spelt = given[i].spelling->name;
    bool const place = spelt == "mean" || spelt == "median" || spelt == "location" || spelt == "lower" || spelt == "upper";
    auto const value = argument_in(argument_unit, *given[i].value, std::string(spelt), !place);
    if (!value) {
      good = false;
      continue;
    }
    Typed argument_value = *value;
    if (!place) {
      argument_value.unit.offset = 0;
      if (argument_unit) argument_unit->offset = 0;
    }
    NodeId node = adapt(graph, argument_value, argument_unit);
    if (given[i].spelling->to_canonical != nullptr) node = given[i].spelling->to_canonical(graph, node, use.arguments);
    use.arguments.push_back(node);
  }
  auto const bound = [&](Given const& place, char const* spelt) -> std::optional<NodeId> {
    if (place.value == nullptr) return std::nullopt;
    auto const value = argument_in(unit, *place.value, spelt);
    if (!value) {
      good = false;
      return std::nullopt;
    }
    NodeId const node = adapt(graph, *value, unit);
    auto const number = graph.constant_value(node);
    return number && std::isinf(*number) ? std::nullopt : std::optional(node);
  };
  use.lower = bound(lower, "lower");
  use.upper = bound(upper, "upper");
  if (!good || use.arguments.size() != row->arguments.size()) return std::nullopt;

  if (row->dimensionless && unit && !unit->dimensionless()) {
    std::string const text = unit->text.empty() ? format_dimension(unit->dimension) : unit->text;
    diagnostics.add(row->discrete ? errors::unit_of_count(call.span, name, text) : errors::unit_of_share(call.span, name, text));
    return std::nullopt;
  }

  if (row->discrete && unit && unit->scale != 1) {
    diagnostics.add(errors::unit_of_count(call.span, name, unit->text));
    return std::nullopt;
  }

  std::vector<double> numbers;
  for (NodeId const argument : use.arguments)
    if (auto const number = graph.constant_value(argument)) numbers.push_back(*number);
  if (numbers.size() == use.arguments.size() && row->refuse != nullptr) {
    if (std::string_view const reason = row->refuse(numbers); !reason.empty()) {
      diagnostics.add(errors::bad_arguments(call.span, name, reason));
      return std::nullopt;
    }
  }
  if (use.lower && use.upper) {
    auto const a = graph.constant_value(*use.lower), b = graph.constant_value(*use.upper);
    if (a && b && !(*a < *b)) {
      diagnostics.add(errors::bad_arguments(call.span, name, "lower is not below upper"));
      return std::nullopt;
    }
  }
  if (row->proper && (use.lower || use.upper)) {
    auto const left = graph.constant_value(mass(graph, use));
    if (left && !(*left > 0)) {
      diagnostics.add(errors::no_mass(call.span, name));
      return std::nullopt;
    }
  }
  return use;
}

}  // namespace sysid
