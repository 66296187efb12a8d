// Messages about units. As everywhere: lower case, no full stop; the units stand under the places, `help` says what to do.
#include "check/units/unit_errors.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "check/message/error_words.hpp"
#include "check/units/units.hpp"
#include "core/text/without_index.hpp"

namespace sysid::errors {
namespace {

Diagnostic at(Severity severity, std::string code, Label primary, std::vector<Label> secondary, std::string message,
              std::string help) {
  return {severity, std::move(code), std::move(message), std::move(primary), std::move(secondary), std::move(help)};
}

std::string term_message(UnitConflict const& conflict) {
  switch (conflict.position) {
    case UnitConflict::Position::other_side:
      return "the two sides of this equation have different units";
    case UnitConflict::Position::after:
      return fmt::format("this term cannot be added to the {} before it", conflict.several ? "ones" : "one");
    case UnitConflict::Position::before:
      break;
  }
  return fmt::format("this term cannot be added to the {} after it", conflict.several ? "ones" : "one");
}

std::string with_names(std::string const& cure, std::string const& names) {
  if (names.empty()) return cure;
  return fmt::format("{}, such as {}", cure, names);
}

std::string subject(Temperature const& temperature) {
  bool const as_written = temperature.is_name || temperature.is_number;
  return as_written ? "`" + temperature.text + "`" : "the quantities from which this is computed";
}

char const* verb(Temperature const& temperature) { return temperature.is_number ? "write" : "declare"; }

}  // namespace

Diagnostic units_differ(Occasion const& occasion, UnitConflict conflict) {
  std::string code, message, help = conflict.help;
  switch (occasion.kind) {
    case Occasion::Kind::terms:
      code = "E2103";
      message = term_message(conflict);
      break;
    case Occasion::Kind::comparison:
      code = "E2201";
      message = "quantities of different units cannot be compared";
      break;
    case Occasion::Kind::branches:
      code = "E2202";
      message = fmt::format("the branches of `{}` have different units", occasion.what.empty() ? "if" : occasion.what);
      break;
    case Occasion::Kind::arguments:
      code = "E2203";
      message = fmt::format("the arguments of `{}` have different units", occasion.what);
      break;
    case Occasion::Kind::declared:
      code = "E2204";
      message = fmt::format("`{}` is in [{}], but this is in [{}]", occasion.what, conflict.wanted, conflict.found);
      break;
    case Occasion::Kind::distribution:
      code = "E2205";
      message = fmt::format("`{}` for `{}` must be {}, but this is in [{}]", occasion.what, occasion.of,
                            conflict.wanted == "-" ? "a pure number" : fmt::format("in [{}]", conflict.wanted), conflict.found);
      break;
  }
  Diagnostic result = at(Severity::error, code, conflict.primary, conflict.secondary, message, help);
  for (std::string const& name : {occasion.what, occasion.of})
    if (!name.empty()) result = errors::also_about(with_bare(name), std::move(result));
  return result;
}

Diagnostic pure_argument(Label argument, std::string const& function, std::string help) {
  return errors::about({function}, at(Severity::error, "E2206", std::move(argument), {},
                                      fmt::format("`{}` takes a pure number", function), std::move(help)));
}
Diagnostic exponent_with_unit(Label exponent, std::string help) {
  return at(Severity::error, "E2207", std::move(exponent), {}, "an exponent must be a pure number", std::move(help));
}
Diagnostic base_with_unit(Label base, Span exponent, std::string const& text, std::string const& unit) {
  return at(Severity::error, "E2208", std::move(base), {{exponent, "not known before the run"}},
            "the unit of this power is not known: its base has a unit, but its exponent is not a constant",
            fmt::format("make the base a pure number: divide `{}` by a reference value in [{}]", text, unit));
}
Diagnostic condition_with_unit(Label condition, std::string const& text, bool before_value) {
  return at(Severity::error, "E2209", std::move(condition), {}, "a condition is true or false, not a quantity with a unit",
            fmt::format("compare it: `{} > 0`{}", text, before_value ? "; in `piecewise` a condition comes before its value" : ""));
}
Diagnostic zeros_differ(Zeros zeros, Temperature shown, Temperature other) {
  bool const shows_zero = shown.unit.offset != 0;
  Temperature const &with_zero = shows_zero ? shown : other, &without = shows_zero ? other : shown;
  std::string message, help;
  switch (zeros) {
    case Zeros::in_doubt:
      message = "this sum is ambiguous: a temperature or a difference of temperatures";
      help = without.unit.offset == 0
                 ? fmt::format("if {0} is a difference, {1} it in [{2}]; if it is a temperature, {1} it in [{3}]", subject(without),
                               verb(without), difference(with_zero.unit).text, with_zero.unit.text)
                 : fmt::format("use one unit for {} and {}: [{}] for temperatures or [{}] for differences", subject(without),
                               subject(with_zero), with_zero.unit.text, difference(with_zero.unit).text);
      break;
    case Zeros::of_difference:
      message = "one of these is a temperature, the other a difference of temperatures";
      help = without.text.empty()
                 ? fmt::format("to get a difference, subtract a reference temperature: `{} - 20 [{}]`", with_zero.text,
                               with_zero.unit.text)
                 : fmt::format(
                       "to get a temperature, add a reference temperature: `20 [{}] + {}`; if both sides are differences, "
                       "{} {} in [{}]",
                       with_zero.unit.text, without.text, verb(with_zero), subject(with_zero), difference(with_zero.unit).text);
      break;
    case Zeros::agree:
    case Zeros::apart:
      message = "these temperatures have different zero points";
      help = fmt::format("{} {} in [{}] as well: columns and numbers are converted, expressions are not", verb(shown),
                         subject(shown), other.unit.text.empty() ? "K" : other.unit.text);
      break;
  }
  return at(Severity::error, "E2211", std::move(shown.label), {std::move(other.label)}, message, help);
}
Diagnostic cycles_meet_radians(Label shown, Label other, bool counts_cycles, std::string const& moved) {
  std::string help = counts_cycles ? "multiply this by 2*pi" : "divide this by 2*pi";
  if (!moved.empty()) help = fmt::format("2*pi belongs on the other side of the fraction: write `{}`", moved);
  return at(Severity::warning, "E2210", std::move(shown), {std::move(other)},
            "a frequency in cycles is combined with one in radians without 2*pi", std::move(help));
}
Diagnostic cycles_as_angular(Label shown, Label other, std::string const& name) {
  shown.text = name.empty() ? "counts cycles" : fmt::format("`{}` counts cycles", name);
  return at(
      Severity::warning, "E2210", std::move(shown), {std::move(other)},
      "a frequency in cycles is used as an angular frequency, without 2*pi",
      name.empty()
          ? "multiply the frequency by 2*pi"
          : fmt::format("write `2*pi*{0}` instead of `{0}`; if its values are angular frequencies, declare it in [rad/s]", name));
}
Diagnostic cycles_in_angle(Span argument, std::string const& function) {
  return errors::about({function}, at(Severity::warning, "E2210", {argument, "cycles"}, {},
                                      fmt::format("`{}` takes radians, but this counts cycles", function), "multiply by 2*pi"));
}
Diagnostic number_beside(Span number, Label other, bool angle, std::string const& text, std::string const& unit,
                         std::string const& name) {
  std::string const one = angle ? "rad" : "-";
  std::string help = fmt::format("write `{0} [{1}]` or `{0} [{2}]`", text, unit, one);
  if (name == "1") help = fmt::format("multiply it by `1 [{}]` or by `1 [{}]`", unit, one);
  if (!name.empty() && name != "1") help = fmt::format("declare `{}` in [{}] or in [{}]", name, unit, one);
  return at(Severity::warning, "E2213", {number, angle ? "in radians" : "a pure number"}, {std::move(other)},
            fmt::format("`{}` has no unit: beside what is in [{}] it is {}", text, unit, angle ? "in radians" : "a pure number"),
            help);
}
Diagnostic constant_beside(Span constant, Label other, std::string const& name, std::string const& unit, std::string const& base) {
  return errors::about({name}, at(Severity::warning, "E2213", {constant, fmt::format("in [{}]", base)}, {std::move(other)},
                                  fmt::format("`{}` has no unit: beside what is in [{}] it is in [{}]", name, unit, base),
                                  fmt::format("declare `{}` in [{}] or in [{}]", name, unit, base)));
}
Diagnostic degrees_as_radians(Span number, std::string const& function, std::string const& text) {
  return errors::about({function}, at(Severity::warning, "E2213", {number, "in radians"}, {},
                                      fmt::format("`{}` has no unit: in `{}` it counts radians", text, function),
                                      fmt::format("write `{0} [deg]` or `{0} [rad]`", text)));
}
Diagnostic degrees_given_to(Span number, Label declared, std::string const& name, std::string const& text) {
  return errors::about(with_bare(name), at(Severity::warning, "E2213", {number, "in radians"}, {std::move(declared)},
                                           fmt::format("`{}` has no unit: `{}` is in radians", text, name),
                                           fmt::format("write `{0} [deg]` or `{0} [rad]`", text)));
}
Diagnostic converted_twice(Label shown, Label declared, std::string const& factor, std::string const& unit,
                           std::string const& written) {
  return at(Severity::warning, "E2214", std::move(shown), {std::move(declared)},
            fmt::format("`{}` looks like a conversion to [{}], which is made automatically", factor, unit),
            fmt::format("write `{}`, unless `{}` is a factor of the formula itself", written, factor));
}
Diagnostic factor_converted(Span shown, std::string const& factor, std::string const& name, std::string const& unit,
                            std::string const& written) {
  return errors::about(
      {name}, at(Severity::warning, "E2214", {shown, ""}, {},
                 fmt::format("`{}` looks like the conversion of `{}` from [{}], which is made automatically", factor, name, unit),
                 fmt::format("write `{}`, unless `{}` is a factor of the formula itself", written, factor)));
}
Diagnostic angle_converted(Span shown, std::string const& factor, std::string const& written) {
  return at(Severity::warning, "E2214", {shown, "an angle with a unit"}, {},
            fmt::format("`{}` converts an angle whose unit is converted automatically", factor),
            fmt::format("write `{}`: a function takes an angle in any unit", written));
}

bool is_unit_conflict(Diagnostic const& diagnostic) {
  return diagnostic.severity == Severity::error && diagnostic.primary &&
         (diagnostic.code == "E2103" || diagnostic.code == "E3206" || diagnostic.code.starts_with("E22"));
}
Diagnostic blamed(Diagnostic conflict, ast::Name const& declared, std::string const& unit, int places) {
  std::string const more =
      places == 2 ? "one more place conflicts with this unit" : fmt::format("{} more places conflict with this unit", places - 1);
  auto const shown = std::find_if(conflict.secondary.begin(), conflict.secondary.end(),
                                  [&](Label const& each) { return each.span == declared.span; });
  if (shown == conflict.secondary.end())
    conflict.secondary.push_back({declared.span, more});
  else
    shown->text += ", " + more;
  conflict.help = fmt::format("{}: then {} agree", declare_in(declared.text, unit),
                              places == 2 ? "both places" : fmt::format("all {} places", places));
  return conflict;
}

Diagnostic letter_taken_for_temperature(Diagnostic conflict, Span written, LetterUnit const& letter) {
  constexpr std::uint32_t blank_and_bracket = 2;
  bool const beside = std::any_of(conflict.secondary.begin(), conflict.secondary.end(), [&](Label const& each) {
    return each.span.end <= written.begin && written.begin - each.span.end <= blank_and_bracket;
  });
  if (!beside) conflict.secondary.push_back({written, fmt::format("the {}", letter.name)});
  conflict.help = fmt::format("`[{}]` is the {}: a temperature in {} is in `[{}]`, and a factor of a unit is `{}`, as in `[J/{}]`",
                              letter.letter, letter.name, letter.scale, letter.temperature, letter.difference, letter.difference);
  return conflict;
}

void move_to_call(Diagnostic& diagnostic, Span call, std::string const& function) {
  diagnostic.function = function;
  diagnostic = also_about({function}, std::move(diagnostic));
  diagnostic.message = fmt::format("in the function `{}`: {}", function, diagnostic.message);
  diagnostic.secondary.insert(diagnostic.secondary.begin(), *diagnostic.primary);
  diagnostic.primary = Label{call, "called here"};
}

std::string multiply_by(std::string_view what, std::string const& kind, std::string const& names) {
  return with_names(fmt::format("multiply {} by {}", what, kind), names);
}
std::string divide_by(std::string_view what, std::string const& kind, std::string const& names) {
  return with_names(fmt::format("divide {} by {}", what, kind), names);
}
std::string declare_in(std::string const& name, std::string const& unit) {
  return fmt::format("declare `{}` in [{}]", without_index(name), unit);
}
std::string number_by_quotient(std::string const& written, double number, std::string const& unit) {
  return fmt::format("the unit of `{}` belongs to the last number alone: write `{:.10g} [{}]`", written, number, unit);
}
std::string gram_for_gravity(std::string const& unit) {
  return fmt::format("`[{0}]` is a mass: an acceleration in units of that of gravity is in `[{0}_n]`", unit);
}
std::string should_be_in(std::string_view what, std::string const& unit) {
  return unit == "-" ? fmt::format("make {} a pure number", what) : fmt::format("make {} a quantity in [{}]", what, unit);
}
std::string zero_in(std::string const& unit) {
  return unit == "-" ? "write `0`: this is a pure number" : fmt::format("write `0 [{}]`", unit);
}
std::string own_width(std::string const& channel, std::string const& unit) {
  return fmt::format("give `{}` a noise parameter of its own in [{}]", channel, unit);
}
std::string declared_in_grams(std::string const& name) {
  return fmt::format("`[g]` is the gram: declare `{}` in [m/s^2], or in [g_n] as a multiple of gravity", name);
}
std::string parentheses_lost(std::string const& written) {
  return fmt::format("what follows a divisor multiplies: did you mean `{}`?", written);
}
std::string reciprocal_meant(std::optional<std::pair<std::string, std::string>> const& quotient, std::string const& unit) {
  if (!quotient) return fmt::format("the reciprocal of this is in [{}]: is a fraction upside down?", unit);
  return fmt::format("did you mean `{}` instead of `{}`?", quotient->second, quotient->first);
}
std::string tag_the_number(std::string const& number, std::string const& unit) {
  return fmt::format("a number as a factor has no unit: write `{} [{}]`", number, unit);
}
std::string inverse_meant(std::string const& name, bool multiplies, std::string const& unit) {
  return multiplies ? fmt::format("divide by `{0}` instead of multiplying by it, or {1}", name, declare_in(name, unit))
                    : fmt::format("multiply by `{0}` instead of dividing by it, or {1}", name, declare_in(name, unit));
}
std::string primes_wrong(std::string const& name, int primes, int wanted, std::string const& coefficient, std::string const& unit) {
  auto const primed = [&](int count) { return name + std::string(static_cast<std::size_t>(count), '\''); };
  std::string const meant = fmt::format("did you mean `{}` instead of `{}`", primed(wanted), primed(primes));
  return coefficient.empty() ? meant + "?" : fmt::format("{}, or `{} [{}]`?", meant, coefficient, unit);
}

}  // namespace sysid::errors
