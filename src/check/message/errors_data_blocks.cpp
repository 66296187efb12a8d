// The checker's wording about data blocks, and about bringing them together with models.
#include <fmt/format.h>

#include <algorithm>

#include "check/message/error_words.hpp"
#include "syntax/foreign_words.hpp"

namespace sysid::errors {
namespace {

constexpr Synonym setting_synonyms[] = {{"header", "names"},      {"delimiter", "separator"}, {"sep", "separator"},
                                        {"delim", "separator"},   {"nan", "missing"},         {"na", "missing"},
                                        {"na_values", "missing"}, {"datetime", "stamp"},      {"charset", "encoding"}};

/// "`hold linear` or `hold cubic`".
std::string choice_of_rules(Names rules) {
  for (std::string& each : rules) each = "hold " + each;
  return quoted(rules, "or");
}

bool measures_temperature(std::string const& unit) {
  auto const atom = unit_atom(unit), kelvin = unit_atom("K");
  return atom && kelvin && atom->dimension == kelvin->dimension;
}

/// Loggers of accelerations write g and mg, which are masses here, and those of temperatures C and F.
std::string unit_help(std::string const& column_unit, std::string const& declared_unit) {
  for (auto const& [written, charge] : {std::pair("C", "coulomb"), std::pair("F", "farad")}) {
    bool const of_column = column_unit == written && measures_temperature(declared_unit);
    if (of_column || (declared_unit == written && measures_temperature(column_unit)))
      return fmt::format("`[{0}]` is the {1}: {2} a temperature in `[deg{0}]`", written, charge,
                         of_column ? "write" : "declare in the model");
  }
  if (column_unit == "g") return "`[g]` is the gram; the acceleration of gravity is `[g_n]`";
  if (column_unit == "mg") return "`[mg]` is the milligram; a thousandth of the acceleration of gravity is `[mg_n]`";
  if (column_unit == "ug") return "`[ug]` is the microgram; a millionth of the acceleration of gravity is `[ug_n]`";
  auto const declared = unit_atom(declared_unit);
  if ((column_unit == "kg" || column_unit == "lb") && declared && declared->dimension == unit_atom("N")->dimension)
    return fmt::format("`[{0}]` is a mass: a force is in `[{0}f]`", column_unit);
  if (auto const of_column = unit_atom(column_unit);
      of_column && of_column->dimensionless() && declared && declared->dimensionless())
    return "an angle has a unit: write that of the column, [deg] or [rad]";
  return "correct one of the two units: both must measure the same kind of quantity";
}

}  // namespace

Diagnostic no_file(ast::Name const& block) {
  return about({block.text}, error("E4101", block.span, fmt::format("data block `{}` names no file", block.text),
                                   "add `file \"measurement.csv\"`"));
}

Diagnostic no_time(ast::Name const& block) {
  return about({block.text},
               error("E4102", block.span, fmt::format("data block `{}` does not define the time of its rows", block.text),
                     "add `time t [s]` (a column) or `rate 1000 [Hz]`"));
}

Diagnostic time_and_rate(Span second, Span first) {
  return conflict("E4103", second, "and here", first, "here", "the time is given twice, by a column and by a rate",
                  "remove the column or the rate");
}

Diagnostic stated_twice(Span second, Span first, Subject const& what) {
  return about(what.names, conflict("E4104", second, "again here", first, "first here",
                                    fmt::format("{} is given twice", what.words), "keep one"));
}

Diagnostic rule_missing(Span span, std::string const& input, Names const& rules) {
  return about({input},
               error("E4105", span, fmt::format("no rule is given for the values of input `{}` between its samples", input),
                     fmt::format("add {}: the choice strongly affects the result", choice_of_rules(rules))));
}

Diagnostic unknown_rule(ast::Name const& rule, Names const& known) {
  std::string help = guess_or(rule.text, known, fmt::format("rules: {}", quoted(known)));
  if (std::string_view const ours = words::translated(words::foreign_input_rules(), rule.text); !ours.empty())
    help = fmt::format("did you mean `{}`?", ours);
  return about({rule.text}, error("E4106", rule.span, fmt::format("there is no input rule `{}`", rule.text), std::move(help)));
}

Diagnostic unknown_reading(ast::Name const& setting, Names const& known) {
  constexpr std::string_view of_first_row[] = {"skip", "skiprows", "skip_rows", "header_lines", "headerlines"};
  if (std::find(std::begin(of_first_row), std::end(of_first_row), setting.text) != std::end(of_first_row))
    return about({setting.text}, error("E4117", setting.span, fmt::format("`read` has no setting `{}`", setting.text),
                                       "write the line where the values begin: `read values = 2` if there is one line above them"));
  return about({setting.text}, error("E4117", setting.span, fmt::format("`read` has no setting `{}`", setting.text),
                                     guess_or(setting_synonyms, setting.text, known, fmt::format("settings: {}", quoted(known)))));
}

Diagnostic bad_reading(Span span, std::string const& setting, std::string const& wanted, std::string const& usage) {
  return about({setting},
               error("E4118", span, fmt::format("`{}` {}", setting, wanted), fmt::format("for example `read {}`", usage)));
}

Diagnostic reading_contradicts(Span span, std::string const& reason) {
  return error("E4118", span, reason, "see `sysid list reading` for all settings");
}

Diagnostic not_a_time(Span span, Unit const& unit) {
  return error("E4114", span, fmt::format("time cannot be {}", measure(unit)), "give a unit of time: [s], [ms], [min], [h]");
}

Diagnostic rate_not_positive(Span span) {
  return error("E4107", span, "the sampling rate or step must be a positive number",
               "for example `rate 1000 [Hz]` or `step 1 [ms]`");
}

Diagnostic bad_rows(Span span) {
  return error("E4108", span, "row numbers must be whole numbers from 1, the first not above the last",
               "for example `split train = rows 1..500`");
}

Diagnostic input_not_bound(Span span, std::string const& input, Subject const& owner, std::string const& data) {
  return also_about(
      owner.names,
      about({data, input},
            error("E4109", span, fmt::format("data block `{}` does not provide input `{}` of {}", data, input, owner.words),
                  fmt::format("add `input {} = COLUMN [unit] hold RULE` to the data block", input))));
}

Diagnostic no_channel_bound(Span span, Subject const& owner, std::string const& data, Names const& channels) {
  return also_about(owner.names,
                    about({data}, error("E4110", span, fmt::format("data block `{}` measures no channel of {}", data, owner.words),
                                        fmt::format("add `measure {} = COLUMN [unit]` to the data block",
                                                    channels.empty() ? "CHANNEL" : channels.front()))));
}

Diagnostic unknown_input(Span span, std::string const& input, std::string const& unit, Subject const& owner, Names const& inputs) {
  std::string const declared =
      fmt::format("declare it in the model, `input {}{}`, and use it in an equation", input, unit.empty() ? "" : " [" + unit + "]");
  return also_about(owner.names,
                    about({input}, error("E4115", span, fmt::format("{} has no input `{}`", owner.words, input),
                                         inputs.empty() ? declared : guess_or(input, inputs, choose(inputs, "input")))));
}

Diagnostic unknown_channel(Span span, std::string const& channel, Subject const& owner, Names const& channels) {
  return also_about(owner.names, about({channel}, error("E4111", span, fmt::format("{} has no channel `{}`", owner.words, channel),
                                                        guess_or(channel, channels,
                                                                 fmt::format("remove this line, or add `observe {} ~ normal(...)` "
                                                                             "to the model; {}",
                                                                             channel, choose(channels, "channel"))))));
}

Diagnostic channel_of_other_name(Span span, std::string const& channel, Subject const& owner, std::string const& own,
                                 std::pair<std::string, std::string> const& column_and_unit) {
  Diagnostic result = unknown_channel(span, channel, owner, {own});
  if (!did_you_mean(channel, Names{own}).empty()) return result;
  auto const& [column, unit] = column_and_unit;
  bool const word = words::begins_name(column[0]) && std::all_of(column.begin(), column.end(), words::continues_name);
  result.help =
      fmt::format("{0} observes `{1}`: write `measure {1} = {2}{3}`, or rename the channel in the model, `observe {4} ~ ...`",
                  owner.words, own, word ? column : "\"" + column + "\"", unit.empty() ? "" : " [" + unit + "]", channel);
  return result;
}

Diagnostic rate_under_zero_order(Span rule, Span use, std::string const& input, Names const& rules) {
  return about({input, primed(input, 1)},
               conflict("E4112", rule, "held between samples", use, "its derivative is used here",
                        fmt::format("`{}'` does not exist: input `{}` is held constant between its samples", input, input),
                        "choose " + choice_of_rules(rules)));
}

Diagnostic unit_mismatch(Span span, Subject const& what, std::string const& column_unit, std::string const& declared_unit) {
  return about(what.names,
               error("E4113", span, fmt::format("{} is in [{}], but [{}] is needed", what.words, column_unit, declared_unit),
                     unit_help(column_unit, declared_unit)));
}

Diagnostic constant_of_nothing(Span span, std::string const& name, std::string const& model, Names const& known) {
  return about({model, name},
               error("E6301", span, fmt::format("model `{}` has no parameter `{}`", model, name),
                     guess_or(name, known,
                              known.empty() ? fmt::format("declare it in the model: `parameter {} per experiment`", name)
                                            : fmt::format("parameters that a data block can fix: {}", quoted(known)))));
}

Diagnostic constant_of_shared(Span span, Span declaration, std::string const& parameter) {
  return about({parameter},
               conflict("E6302", span, "fixed for one experiment", declaration, "shared by all",
                        fmt::format("parameter `{}` is shared by all experiments: a data block cannot fix it", parameter),
                        fmt::format("declare it as `parameter {} per experiment`, or give it this value in the model", parameter)));
}

Diagnostic constant_missing(Span use, Span declaration, std::string const& parameter, std::string const& data) {
  return about(
      {data, parameter},
      conflict("E6303", use, "used here", declaration, "neither prior nor value",
               fmt::format("data block `{}` gives no value for `{}`", data, parameter),
               fmt::format("add `constant {} = ...` to data `{}`, or give the parameter a prior or a value", parameter, data)));
}

}  // namespace sysid::errors
