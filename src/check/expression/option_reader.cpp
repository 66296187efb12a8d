// Reading options.
#include "check/expression/option_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "check/message/errors.hpp"

namespace sysid {
namespace {

constexpr int default_start_rows = 50;
constexpr double example_burn_in = 1000;

/// Of `schedule = 100, 10, 1`, a list without its parentheses: the last of its numbers; `first` where it has them.
std::size_t end_of_list(ast::Call const& call, std::size_t first, std::span<SettingRow const> rows) {
  std::string const& name = call.arguments[first].name->text;
  bool const list = std::any_of(rows.begin(), rows.end(),
                                [&](SettingRow const& each) { return each.kind == SettingKind::numbers && each.name == name; });
  std::size_t last = first;
  while (list && last + 1 < call.arguments.size() && !call.arguments[last + 1].name) ++last;
  return last;
}

}  // namespace

Unit unit_of(std::string_view atom) { return atom.empty() ? Unit{} : unit_atom(atom).value(); }

std::string key_of(ast::Option const& option) {
  if (option.key) return option.key->text;
  if (auto const* call = std::get_if<ast::Box<ast::Call>>(&option.value.node)) return (*call)->function.text;
  if (auto const* reference = std::get_if<ast::Reference>(&option.value.node)) return reference->name.text;
  return {};
}

ast::Call const* as_call(ast::Expression const& expression) {
  auto const* call = std::get_if<ast::Box<ast::Call>>(&expression.node);
  return call == nullptr ? nullptr : &**call;
}

Span head_span(ast::Expression const& expression) {
  auto const* call = as_call(expression);
  return call == nullptr ? expression.span : call->function.span;
}

std::optional<std::string> as_word(ast::Expression const& expression) {
  if (auto const* reference = std::get_if<ast::Reference>(&expression.node); reference != nullptr && reference->primes == 0)
    return reference->name.text;
  if (auto const* text = std::get_if<ast::Text>(&expression.node)) return text->value;
  return std::nullopt;
}

void OptionReader::setting(ast::Argument const& argument, SettingRow const& row, Settings& values) {
  std::string const name(row.name);
  switch (row.kind) {
    case SettingKind::integer:
      if (auto const value = number(argument.value, name, Unit{}, row.minimum, row.maximum, true))
        values.set(name, static_cast<std::int64_t>(*value));
      break;
    case SettingKind::real:
      if (auto const value = pure_number(argument.value, name, unit_of(row.unit), row.minimum, row.maximum)) {
        if (*value > 0 && *value < row.least_positive)
          diagnostics_.add(errors::option_range_or_zero(argument.value.span, name, *value, row.least_positive, row.maximum));
        values.set(name, *value);
      }
      break;
    case SettingKind::flag:
      if (auto const value = yes_or_no(argument.value, name)) values.set(name, *value);
      break;
    case SettingKind::numbers: {
      auto const* list = std::get_if<ast::Box<ast::List>>(&argument.value.node);
      std::vector<double> all;
      for (ast::Expression const& item : list == nullptr ? std::vector{argument.value} : (*list)->items)
        if (auto const value = pure_number(item, name, Unit{}, row.minimum, row.maximum)) all.push_back(*value);
      values.set(name, std::move(all));
      break;
    }
    case SettingKind::word: {
      std::vector<std::string> choices;
      std::istringstream stream{std::string(row.choices)};
      for (std::string choice; stream >> choice;) choices.push_back(choice);
      auto const word = as_word(argument.value);
      if (word && std::find(choices.begin(), choices.end(), *word) != choices.end())
        values.set(name, *word);
      else
        diagnostics_.add(errors::option_choice(argument.value.span, name, word.value_or(""), choices));
      break;
    }
  }
}

std::optional<double> OptionReader::number(ast::Expression const& tree, std::string const& name, std::optional<Unit> const& unit,
                                           double least, double most, bool whole, std::optional<OtherPlace> const& elsewhere) {
  auto const value = scope_.expression(tree);
  if (!value || (whole && refused_angle(*value, tree.span, name, unit))) return std::nullopt;
  return number_of(*value, tree.span, name, unit, least, most, whole, elsewhere);
}

std::optional<double> OptionReader::pure_number(ast::Expression const& tree, std::string const& name, Unit const& unit,
                                                double least, double most) {
  auto const value = scope_.expression(tree);
  if (!value || refused_angle(*value, tree.span, name, unit)) return std::nullopt;
  return number_of(*value, tree.span, name, unit, least, most, false, std::nullopt);
}

bool OptionReader::refused_angle(Typed const& value, Span place, std::string const& name, std::optional<Unit> const& unit) {
  bool const angle = unit && unit->dimensionless() && unit->radian.numerator == 0 && value.kind == Typed::Kind::known &&
                     value.unit.dimensionless() && value.unit.radian.numerator != 0;
  if (angle) diagnostics_.add(errors::number_of_other_kind(place, errors::named(name), value.unit, *unit));
  return angle;
}

std::optional<double> OptionReader::width(ast::Expression const& tree, std::string const& name, std::optional<Unit> unit,
                                          double least) {
  auto value = scope_.expression(tree);
  if (!value) return std::nullopt;
  value->unit.offset = 0;
  if (unit) unit = difference(*unit);
  return number_of(*value, tree.span, name, unit, least, 1e300, false, std::nullopt);
}

std::optional<double> OptionReader::number_of(Typed const& value, Span place, std::string const& name,
                                              std::optional<Unit> const& unit, double least, double most, bool whole,
                                              std::optional<OtherPlace> const& elsewhere) {
  if (unit && value.kind == Typed::Kind::known)
    if (auto refused = refuse_number(place, errors::named(name), value.unit, *unit)) {
      if (elsewhere && !refuse_number(place, errors::named(name), value.unit, elsewhere->unit)) refused->help = elsewhere->help;
      diagnostics_.add(std::move(*refused));
      return std::nullopt;
    }
  auto const constant = graph_.constant_value(adapt(graph_, value, unit));
  if (!constant) {
    diagnostics_.add(errors::constant_needed(place, errors::named(name)));
    return std::nullopt;
  }
  bool const scaled = value.kind == Typed::Kind::known && value.unit.scale != 1;  // 100 [percent] is no count
  if (whole && (scaled || *constant != std::floor(*constant))) {
    double nearest = std::round(scaled ? *constant / value.unit.scale : *constant);
    // A share of the iterations, as other programs have it.
    if (name == "burn_in" && *constant <= 1) nearest = example_burn_in;
    diagnostics_.add(
        errors::option_kind(place, name, {"a whole number"}, fmt::format("{} = {:.0f}", name, std::clamp(nearest, least, most))));
    return std::nullopt;
  }
  if (!(*constant >= least && *constant <= most)) {
    diagnostics_.add(errors::option_range(place, name, *constant, least, most));
    return std::nullopt;
  }
  return constant;
}

std::optional<bool> OptionReader::yes_or_no(ast::Expression const& tree, std::string const& name) {
  auto const word = as_word(tree);
  if (word == "yes" || word == "no") return word == "yes";
  diagnostics_.add(errors::option_choice(tree.span, name, word.value_or(""), {"yes", "no"}));
  return std::nullopt;
}

void OptionReader::flag(ast::Option const& option, std::string const& name, bool& place) {
  if (auto const value = yes_or_no(option.value, name)) place = *value;
}

void OptionReader::whole(ast::Option const& option, std::string const& name, double least, double most, int& place) {
  if (auto const value = number(option.value, name, Unit{}, least, most, true)) place = static_cast<int>(*value);
}

void OptionReader::seed(ast::Option const& option, std::optional<std::uint64_t>& place) {
  if (auto const value = number(option.value, "seed", Unit{}, 0, 9007199254740992.0, true))
    place = static_cast<std::uint64_t>(*value);
}

void OptionReader::start(ast::Option const& option, StartRule& rule) {
  std::vector<std::string> const choices = {"record", "rest", "estimated"};
  if (ast::Call const* call = as_call(option.value)) {
    if (call->function.text == "estimated") {
      rule = {StartRule::Kind::estimated, default_start_rows};
      std::optional<Span> given;
      for (ast::Argument const& argument : call->arguments) {
        if (argument.name && argument.name->text != "rows") {
          diagnostics_.add(errors::unknown_argument(*argument.name, "estimated", {"rows"}));
        } else if (given) {
          diagnostics_.add(errors::stated_twice(argument.span, *given, errors::named("rows")));
        } else if (auto const rows = number(argument.value, "rows", Unit{}, 2, 1e9, true, time_for_rows())) {
          rule.rows = static_cast<int>(*rows);
        }
        if (!given) given = argument.span;
      }
      return;
    }
    diagnostics_.add(errors::option_choice(option.value.span, "start", call->function.text, choices));
    return;
  }
  auto const word = as_word(option.value);
  if (word == "record") {
    rule = {StartRule::Kind::record, 0};
  } else if (word == "rest") {
    rule = {StartRule::Kind::rest, 0};
  } else if (word == "estimated") {
    rule = {StartRule::Kind::estimated, default_start_rows};
  } else {
    diagnostics_.add(errors::option_choice(option.value.span, "start", word.value_or(""), choices));
  }
}

bool OptionReader::solver(ast::Option const& option, SolverSettings& place) {
  if (solver_) {
    diagnostics_.add(errors::stated_twice(option.span, *solver_, {"the solver"}));
    return true;
  }
  solver_ = option.span;
  if (option.key->text == "substeps") {
    if (as_word(option.value) == "automatic") return false;
    whole(option, "substeps", 1, 10000, place.substeps);
    return true;
  }
  ast::Call const* call = as_call(option.value);
  std::string const name = call != nullptr ? call->function.text : as_word(option.value).value_or("");
  SolverRow const* row = find_solver(name);
  if (row == nullptr) {
    std::vector<std::string> names;
    for (SolverRow const& each : solvers()) names.emplace_back(each.name);
    diagnostics_.add(errors::option_choice(head_span(option.value), "solver", name, names));
    return true;
  }
  Settings values(row->settings);
  if (call != nullptr) settings(*call, row->settings, values);
  place = make_solver(*row, values);
  if (place.as_model || row->exact) return true;
  return call != nullptr && std::any_of(call->arguments.begin(), call->arguments.end(), [](ast::Argument const& argument) {
           // Neither the work budget nor `as_model = no` is a statement of accuracy.
           return argument.name && argument.name->text != "steps" && argument.name->text != "as_model";
         });
}

errors::OptionOwner OptionReader::owner(std::string name, std::string_view option) const {
  return {std::move(name), verb_, verbs_with_ == nullptr ? errors::Names() : verbs_with_(option)};
}

void OptionReader::unknown(ast::Option const& option, std::vector<std::string> const& known) {
  std::string const key = key_of(option);
  if (key.empty())
    diagnostics_.add(errors::option_without_name(option.value, verb_));
  else
    diagnostics_.add(
        errors::unknown_option(option.key ? option.key->span : head_span(option.value), key, owner(verb_, key), known));
}

bool OptionReader::fresh(ast::Option const& option, std::string const& key) {
  auto const [place, is_fresh] = seen_.emplace(option.input ? "input " + key : key, option.span);
  if (!is_fresh) diagnostics_.add(errors::stated_twice(option.span, place->second, errors::named(place->first)));
  return is_fresh;
}

bool OptionReader::fresh_backend(ast::Option const& option) {
  if (backend_) diagnostics_.add(errors::stated_twice(option.span, *backend_, errors::Subject{"the back end"}));
  bool const is_fresh = !backend_;
  if (is_fresh) backend_ = option.span;
  return is_fresh;
}

void OptionReader::settings(ast::Call const& call, std::span<SettingRow const> rows, Settings& values) {
  std::vector<std::string> known;
  for (SettingRow const& row : rows) known.emplace_back(row.name);
  std::map<std::string, Span> given;
  for (std::size_t i = 0; i < call.arguments.size(); ++i) {
    ast::Argument const& argument = call.arguments[i];
    if (std::size_t const last = argument.name ? end_of_list(call, i, rows) : i; last > i) {
      diagnostics_.add(errors::list_without_parentheses(call, i, last));
      i = last;
      continue;
    }
    if (!argument.name) {
      diagnostics_.add(known.empty() ? errors::too_many_arguments(call, argument, known)
                                     : errors::must_be_named(call, argument, known));
      continue;
    }
    std::string const& name = argument.name->text;
    auto const row = std::find_if(rows.begin(), rows.end(), [&](SettingRow const& each) { return each.name == name; });
    if (row == rows.end()) {
      diagnostics_.add(errors::unknown_option(argument.name->span, name, owner(call.function.text, name), known));
      continue;
    }
    if (auto const [place, is_fresh] = given.emplace(name, argument.span); !is_fresh) {
      diagnostics_.add(errors::stated_twice(argument.span, place->second, errors::named(name)));
      continue;
    }
    setting(argument, *row, values);
  }
}

}  // namespace sysid
