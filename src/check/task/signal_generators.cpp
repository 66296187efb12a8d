// One row for each signal: its arguments with their units, how it runs between samples.
#include "check/task/signal_generators.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "check/checked/harmonics.hpp"
#include "check/message/errors.hpp"
#include "core/setting/table.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

struct SignalArgument {
  std::string_view name;
  std::string_view unit;  // of its own; "input": that of the input
  double fallback;        // NaN: needed
};
struct SignalRow {
  std::string_view name;
  InputGenerator::Kind kind;
  std::vector<SignalArgument> arguments;
  InputRule rule;
};
std::vector<SignalRow> const& signals() {
  double const needed = std::nan("");
  static std::vector<SignalRow> const rows = {
      {"gaussian", InputGenerator::Kind::gaussian, {{"mean", "input", 0}, {"sd", "input", needed}}, InputRule::zero_order},
      {"sine",
       InputGenerator::Kind::sine,
       {{"amplitude", "input", needed}, {"frequency", "Hz", needed}, {"phase", "rad", 0}, {"mean", "input", 0}},
       InputRule::cubic},
      {"multisine",
       InputGenerator::Kind::multisine,
       {{"sd", "input", needed}, {"lowest", "Hz", needed}, {"highest", "Hz", needed}, {"mean", "input", 0}},
       InputRule::band_limited},
      {"constant", InputGenerator::Kind::constant, {{"value", "input", needed}}, InputRule::zero_order},
  };
  return rows;
}

std::vector<std::string> arguments_of(SignalRow const& row) {
  std::vector<std::string> names;
  for (SignalArgument const& argument : row.arguments) names.emplace_back(argument.name);
  names.emplace_back("hold");
  return names;
}

constexpr std::string_view example_sine = "write for example `sine(amplitude = 1, frequency = 1 [Hz])`",
                           example_cosine = "write for example `sine(amplitude = 1, frequency = 1 [Hz], phase = 90 [deg])`";

/// The signal that `sin(2*pi*t)`, `2*cos(w*t)` stand for; empty where neither occurs.
std::string_view instead_of_sine(ast::Expression const& value) {
  std::string_view meant;
  each_expression(value, [&](ast::Expression const& each) {
    auto const* call = std::get_if<ast::Box<ast::Call>>(&each.node);
    if (call == nullptr || !meant.empty()) return;
    if ((*call)->function.text == "sin") meant = example_sine;
    if ((*call)->function.text == "cos") meant = example_cosine;
  });
  return meant;
}

/// Its arguments, first those that it needs and that are not given.
std::vector<std::string> arguments_to_name(SignalRow const& row, ast::Call const& call) {
  std::vector<std::string> needed, others;
  for (SignalArgument const& argument : row.arguments) {
    bool const given = std::any_of(call.arguments.begin(), call.arguments.end(),
                                   [&](ast::Argument const& each) { return each.name && each.name->text == argument.name; });
    (std::isnan(argument.fallback) && !given ? needed : others).emplace_back(argument.name);
  }
  needed.insert(needed.end(), others.begin(), others.end());
  needed.emplace_back("hold");
  return needed;
}

// `90` where an angle is wanted. What has a unit, or is computed from pi, is meant as it is written.
bool is_bare_angle_beyond_turn(ast::Expression const& tree) {
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node)) return is_bare_angle_beyond_turn(*(*unary)->operand);
  constexpr double turn = 6.3;
  auto const* number = std::get_if<ast::Number>(&tree.node);
  return number != nullptr && !number->unit && std::abs(number->value) > turn;
}

/// `gaussian(0, 10)` with the names of its arguments; empty for a single one, and where some have names.
std::string in_order(SignalRow const& row, ast::Call const& call) {
  std::size_t const count = call.arguments.size();
  if (count < 2 || count > row.arguments.size()) return {};
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    if (call.arguments[i].name) return {};
    ast::Expression const& value = call.arguments[i].value;
    bool const degrees = row.arguments[i].unit == "rad" && is_bare_angle_beyond_turn(value);
    text += fmt::format("{}{} = {}{}", i == 0 ? "" : ", ", row.arguments[i].name, unparse(value), degrees ? " [deg]" : "");
  }
  return fmt::format("write `{}({})`", row.name, text);
}

}  // namespace

std::vector<std::string> signal_names() {
  std::vector<std::string> names;
  for (SignalRow const& row : signals()) names.emplace_back(row.name);
  return names;
}

std::vector<std::string> signal_arguments(std::string_view signal) {
  SignalRow const* row = row_named(signals(), signal);
  return row == nullptr ? std::vector<std::string>() : arguments_of(*row);
}

std::optional<InputGenerator> check_generator(ast::Option const& option, Quantity const& input, OptionReader& reader,
                                              Diagnostics& diagnostics) {
  ast::Call const* call = as_call(option.value);
  std::vector<std::string> const names = signal_names();
  std::string_view const sine = instead_of_sine(option.value);
  auto const refuse = [&](Diagnostic refused) {
    if (!sine.empty()) refused.help = sine;
    diagnostics.add(std::move(refused));
    return std::nullopt;
  };
  if (call == nullptr)
    return refuse(errors::option_kind(option.value.span, "input " + input.name, {"a generated signal"}, "gaussian(sd = 10)"));
  auto const row =
      std::find_if(signals().begin(), signals().end(), [&](auto const& each) { return each.name == call->function.text; });
  if (row == signals().end())
    return refuse(errors::option_choice(call->function.span, "input " + input.name, call->function.text, names));
  InputGenerator result{row->kind, {}, row->rule};
  std::map<std::string, Span> given;  // rightly or not
  bool unnamed = false;               // what is missing may be meant by it
  std::vector<std::string> const known = arguments_of(*row);
  for (ast::Argument const& argument : call->arguments) {
    std::string const name = argument.name ? argument.name->text : "";
    auto const place =
        std::find_if(row->arguments.begin(), row->arguments.end(), [&](auto const& each) { return each.name == name; });
    if (!argument.name) {
      if (unnamed) continue;
      unnamed = true;
      bool const of_time = row->kind == InputGenerator::Kind::sine && std::get_if<ast::Number>(&argument.value.node) == nullptr;
      Diagnostic refused = errors::must_be_named(*call, argument, arguments_to_name(*row, *call));
      if (std::string whole = in_order(*row, *call); !whole.empty()) refused.help = std::move(whole);
      if (of_time) refused.help = example_sine;
      diagnostics.add(std::move(refused));
    } else if (place == row->arguments.end() && name != "hold") {
      diagnostics.add(errors::unknown_argument(*argument.name, call->function.text, known));
    } else if (auto const [first, is_fresh] = given.emplace(name, argument.span); !is_fresh) {
      diagnostics.add(errors::stated_twice(argument.span, first->second, errors::named(name)));
    } else if (name == "hold") {
      std::string const word = as_word(argument.value).value_or("");
      if (auto const rule = find_input_rule(word))
        result.rule = *rule;
      else
        diagnostics.add(errors::option_choice(argument.value.span, name, word, input_rule_names()));
    } else {
      std::optional<Unit> const unit = place->unit == "input" ? input.unit : unit_of(place->unit);
      bool const is_width = name == "sd" || name == "amplitude";
      bool const is_angle = place->unit == "rad";
      double const least = is_angle || name == "mean" || name == "value" ? -1e300 : 0;
      auto const value =
          is_width ? reader.width(argument.value, name, unit) : reader.number(argument.value, name, unit, least, 1e300);
      if (value && is_angle && is_bare_angle_beyond_turn(argument.value))
        diagnostics.add(errors::angle_beyond_turn(argument.value, name));
      if (value) result.arguments[name] = *value;
    }
  }
  for (SignalArgument const& argument : row->arguments) {
    if (given.contains(std::string(argument.name))) continue;
    if (std::isnan(argument.fallback) && unnamed) continue;
    if (std::isnan(argument.fallback))
      diagnostics.add(errors::argument_missing(*call, {std::string(argument.name)}));
    else
      result.arguments[std::string(argument.name)] = argument.fallback;
  }
  return result;
}

void check_band(InputGenerator const& generator, SimulateTask const& task, Span place, Diagnostics& diagnostics) {
  double const half_rate = 0.5 / task.step;
  if (generator.kind == InputGenerator::Kind::sine && beyond_half_rate(generator.arguments.at("frequency"), task.step))
    diagnostics.add(errors::sine_beyond_half_rate(place, generator.arguments.at("frequency"), half_rate));
  if (generator.kind != InputGenerator::Kind::multisine) return;
  double const lowest = generator.arguments.at("lowest"), highest = generator.arguments.at("highest");
  if (beyond_half_rate(highest, task.step))
    diagnostics.add(errors::multisine_beyond_half_rate(place, highest, half_rate));
  else if (harmonics_in_band(lowest, highest, task.samples, task.step).empty())
    diagnostics.add(errors::multisine_without_harmonic(place, lowest, highest, 1 / (task.samples * task.step)));
}

}  // namespace sysid
