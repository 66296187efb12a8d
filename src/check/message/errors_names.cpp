// The checker's wording about names, calls, units and numbers.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "check/message/error_words.hpp"
#include "function/table.hpp"
#include "syntax/foreign_words.hpp"

namespace sysid::errors {
namespace {

constexpr Synonym unit_synonyms[] = {{"gn", "g_n"}, {"gee", "g_n"}, {"gravity", "g_n"}, {"decc", "degC"}, {"strain", "microstrain"},
                                     {"r", "rev"},  {"rot", "rev"}, {"turn", "rev"},    {"turns", "rev"}, {"revs", "rev"}};

constexpr char const* declared_in_stan =
    "a parameter is declared with its prior, in one statement: write `parameter NAME ~ normal(0, sd = 1, lower = 0)` in place of "
    "this line, or delete it where another line gives the prior";

// Help in place of a guess.
constexpr Synonym name_synonyms[] = {
    {"time", "declare it, `time time [s]`, or, if the model declares the time under another name, use that name"},
    {"t", "declare the time in the model: `time t [s]`"},
    {"π", "write `pi`"},
    {"PI", "write `pi`"},
    {"Pi", "write `pi`"},
    {"initial", "an initial value names its state: `initial y = 0, y' = 0`"},
    {"e", "the exponential function is written `exp(x)`"},
    {"g", "declare it: `constant g = 9.81 [m/s^2]`"},
    {"unknown", "an unknown parameter has a prior: `parameter NAME ~ log_uniform(0.1, 10)`"},
    {"s", "declare it; of a transfer function write the differential equation, a prime for each power of s: `y''` for `s^2*y`"},
    {"i", "declare it; there are no complex numbers: write an equation for the real and one for the imaginary part"},
    {"z", "declare it as state, input or parameter; if it shifts a sample of discrete time, write `lag(y, 1)` for `y*z^-1`"},
    {"free", "an unknown parameter has a prior: `parameter NAME ~ log_uniform(0.1, 10)`"},
    {"estimate", "an unknown parameter has a prior: `parameter NAME ~ log_uniform(0.1, 10)`"},
    {"real", declared_in_stan},
    {"int", declared_in_stan},
    {"lower", "bounds are arguments of a prior: `parameter NAME ~ normal(0, sd = 1, lower = 0)`"},
    {"upper", "bounds are arguments of a prior: `parameter NAME ~ normal(0, sd = 1, upper = 1)`"},
    {"True", "write `1`"},
    {"true", "write `1`"},
    {"False", "write `0`"},
    {"false", "write `0`"},
    {"randn", "noise is written in `observe d ~ normal(y, sd = sigma)`, an unknown force as a `disturbance`"},
    {"rand", "noise is written in `observe d ~ normal(y, sd = sigma)`, an unknown force as a `disturbance`"},
    {"NA", "an unknown parameter has a prior: `parameter NAME ~ log_uniform(0.1, 10)`"},
    {"NaN", "an unknown parameter has a prior: `parameter NAME ~ log_uniform(0.1, 10)`"},
    {"nan", "an unknown parameter has a prior: `parameter NAME ~ log_uniform(0.1, 10)`"},
    {"Inf", "write `inf`"},
    {"infinity", "write `inf`"},
    {"ẏ", "a derivative is written with primes: `y'`"},
    {"ÿ", "a derivative is written with primes: `y''`"},
    {"ẋ", "a derivative is written with primes: `x'`"},
    {"ẍ", "a derivative is written with primes: `x''`"},
};

/// Lowered digits, as paper has them, and how they are typed.
constexpr Synonym lowered_digits[] = {{"₀", "0"}, {"₁", "1"}, {"₂", "2"}, {"₃", "3"}, {"₄", "4"},
                                      {"₅", "5"}, {"₆", "6"}, {"₇", "7"}, {"₈", "8"}, {"₉", "9"}};

std::string typed(std::string name) {
  for (Synonym const& each : lowered_digits)
    for (std::size_t at = 0; (at = name.find(each.foreign, at)) != std::string::npos;)
      name.replace(at, each.foreign.size(), each.ours);
  return name;
}

/// `y0`, `y_0`, `y_init` of a y that there is: its initial value as a parameter.
std::string start_value(std::string const& name, Names const& known) {
  for (std::string const& each : known)
    for (char const* const ending : {"0", "_0", "_init", "_initial"})
      if (name == each + ending)
        return fmt::format("declare it, `parameter {} ~ normal(0, sd = 1)`, or write a number in its place", name);
  return {};
}

constexpr Synonym number_words[] = {{"one", "1"}, {"two", "2"},   {"three", "3"}, {"four", "4"}, {"five", "5"},
                                    {"six", "6"}, {"seven", "7"}, {"eight", "8"}, {"nine", "9"}, {"ten", "10"}};
constexpr char const* no_unit[] = {"none", "unitless", "dimensionless", "pure", "adim", "nondim", "na", "N/A", "count", "counts"};

/// Where no names can stand, in options and data blocks.
Diagnostic name_for_number(ast::Name const& name) {
  std::string help = "write a number";
  for (Synonym const& each : number_words)
    if (name.text == each.foreign) help = fmt::format("write `{}`", each.ours);
  if (name.text == "end" || name.text == "last") help = "write the number of the last row";
  return about({name.text},
               error("E2001", name.span, fmt::format("`{}` is not a number, and names cannot be used here", name.text), help));
}

}  // namespace

Diagnostic unknown_name(ast::Name const& name, Names const& known, Names const& moving) {
  if (known.empty()) return name_for_number(name);
  for (Synonym const& each : name_synonyms)
    if (name.text == each.foreign)
      return about({name.text},
                   error("E2001", name.span, fmt::format("`{}` is not declared in this model", name.text), std::string(each.ours)));
  auto derivative = words::as_derivative(name.text, known, false);
  bool const sure = derivative.has_value();
  if (!sure) derivative = words::as_derivative(name.text, moving, true);
  if (derivative)
    return about({name.text}, error("E2001", name.span, fmt::format("`{}` is not declared in this model", name.text),
                                    sure ? fmt::format("a derivative is written with primes: `{0}'`, `{0}''`", derivative->of)
                                         : fmt::format("a derivative is written with primes, `{}`; declare any other quantity",
                                                       primed(derivative->of, derivative->primes))));
  std::string const plain = typed(name.text);
  if (plain != name.text && std::find(known.begin(), known.end(), plain) != known.end())
    return about({name.text}, error("E2001", name.span, fmt::format("`{}` is not declared in this model", name.text),
                                    fmt::format("did you mean `{}`?", plain)));
  std::string const start = start_value(name.text, known);
  if (!start.empty() || find_function(name.text) != nullptr)
    return about({name.text}, error("E2001", name.span, fmt::format("`{}` is not declared in this model", name.text),
                                    start.empty() ? fmt::format("`{0}` is a function: `{0}(...)`", name.text) : start));
  Diagnostic result = about(
      {name.text}, error("E2001", name.span, fmt::format("`{}` is not declared in this model", name.text),
                         guess_or(plain, known, "declare it as state, input, parameter, constant or local definition (let)")));
  result.suggested = nearest(name.text, known);
  return result;
}

Diagnostic quotient_as_derivative(Span span, ast::Reference const& above, std::string const& name, int primes, bool declared) {
  std::string const& text = above.name.text;
  return about({text}, error("E2001", span, fmt::format("`{}` is not declared in this model", text),
                             fmt::format("a derivative is written with primes: write `{}` in place of the quotient{}",
                                         primed(name, primes), declared ? "" : fmt::format(", and declare `state {}`", name))));
}

Diagnostic duplicate_name(ast::Name const& name, Span first) {
  return about({name.text}, conflict("E2002", name.span, "again here", first, "first declared here",
                                     fmt::format("`{}` is declared twice", name.text), "rename one of the two, or delete it"));
}

Diagnostic definition_cycle(Span span, Names const& loop) {
  return error("E2006", span, fmt::format("this definition is circular: {}", fmt::join(loop, " -> ")),
               "remove the cycle; declare a quantity that depends on its own past as a state with an equation");
}

Diagnostic primes_on(ast::Reference const& reference, std::string const& what) {
  return about({reference.name.text},
               error("E2007", reference.span, fmt::format("`{}` is {}: it has no time derivative", reference.name.text, what),
                     fmt::format("only states and inputs have derivatives; declare `state {}` if it changes with time",
                                 reference.name.text)));
}

Diagnostic primes_on_array(ast::Reference const& reference) {
  Diagnostic out = primes_on(reference, "a definition");
  out.help = fmt::format("a transpose is written `transpose({})`; only states and inputs have derivatives", reference.name.text);
  return out;
}

Diagnostic beyond_highest(ast::Reference const& reference, int order) {
  return about(
      {primed(reference), reference.name.text},
      error("E2007", reference.span,
            fmt::format("`{}` is beyond the highest derivative of `{}` in the equations", primed(reference), reference.name.text),
            fmt::format("replace it by the time derivative of the expression that the equations give for `{}`",
                        primed(reference.name.text, order))));
}

Diagnostic second_input_derivative(ast::Reference const& reference) {
  return about(
      {primed(reference), reference.name.text},
      error("E2008", reference.span, fmt::format("`{}`: only the first derivative of an input is defined", primed(reference)),
            fmt::format("declare the derivative as a separate input; if the equations determine `{0}`, declare it as `state {0}`",
                        reference.name.text)));
}

Diagnostic not_a_number(Span span, Subject const& what) {
  return about(what.names, error("E2009", span, fmt::format("{} cannot be used in an expression", what.words),
                                 "use numbers and names of quantities"));
}

Diagnostic constant_needed(Span span, Subject const& what) {
  return about(what.names, error("E2010", span, fmt::format("{} must be a number known before the run", what.words),
                                 "use numbers, constants and functions of them only"));
}

Diagnostic unknown_unit(ast::Name const& name, std::optional<UnitSlip> const& meant, std::string const& whole) {
  if (name.text == "per")
    return about({name.text}, error("E2011", name.span, "`per` is not a unit", "division is written with `/`: [N s/m]"));
  std::string const message = fmt::format("`{}` is not a known unit", name.text);
  if (std::find(std::begin(no_unit), std::end(no_unit), name.text) != std::end(no_unit))
    return about({name.text}, error("E2011", name.span, message, "a pure number is written `[-]`, or without brackets"));
  if (name.text == "dB" || name.text == "db")
    return about({name.text}, error("E2011", name.span, message,
                                    "a level is a pure number, `[-]`; to declare the quantity in its own unit, convert the level: "
                                    "`10^(level/20)` for an amplitude"));
  if (name.text == "sqrt")
    return about({name.text}, error("E2011", name.span, message, "a root is written as a power: `[V/Hz^(1/2)]`"));
  if (name.text == "gon" || name.text == "grad")
    return about({name.text}, error("E2011", name.span, message, "convert it to degrees: 1 gon is 0.9 [deg]"));
  if (!meant)
    return about({name.text}, error("E2011", name.span, message,
                                    guess_or(unit_synonyms, name.text, common_unit_names(),
                                             "use units of UDUNITS-2 with SI prefixes: [N s/m], [mm], [1/m^2], [rad/s]")));
  switch (meant->kind) {
    case UnitSlip::Kind::power:
      return about({name.text}, error("E2011", name.span, message, fmt::format("a power is written with `^`: `{}`", whole)));
    case UnitSlip::Kind::product:
      return about({name.text},
                   error("E2011", name.span, message, fmt::format("a product is written with a space or `*`: `{}`", whole)));
    case UnitSlip::Kind::capitals:
      return about({name.text}, error("E2011", name.span, message, fmt::format("units are case-sensitive: write `{}`", whole)));
    case UnitSlip::Kind::key:
      return about({name.text}, error("E2011", name.span, message, fmt::format("did you mean `{}`?", whole)));
    case UnitSlip::Kind::molar:
      return about({name.text}, error("E2011", name.span, message, fmt::format("a molar concentration is written `{}`", whole)));
    case UnitSlip::Kind::quotient:
      break;
  }
  return about({name.text}, error("E2011", name.span, message, fmt::format("a quotient is written with `/`: `{}`", whole)));
}

Diagnostic unit_exponent(Span span) {
  return error("E2012", span, "the exponent of a unit must be a whole number or a fraction of small whole numbers",
               "for example [m^2], [N^(1/2)], [s^-1]");
}

Diagnostic list_here(Span span) {
  return error("E2013", span, "a list cannot be used in an expression",
               "parentheses with a comma make a list: write a single value");
}

namespace {

std::string without_wrong_unit(Unit const& given, Unit const& wanted) {
  if (!wanted.dimensionless()) return "correct the unit, or remove it";
  if (!wanted.text.empty() && wanted.text != "-") return fmt::format("write a share, as `1 [{}]`", wanted.text);
  if (given.dimensionless() && given.radian.numerator != 0)
    return "write a pure number: of an angle in [deg] or [rad] it is the number of radians";
  return "remove the unit";
}

/// "1 Hz is 60 rpm".
std::string cycles_in_words(Unit const& given, Unit const& wanted) {
  bool const plain = given.text.empty() || wanted.text.empty() || given.scale == 1 || wanted.radian.numerator != 0;
  if (plain) return "1 Hz is 2*pi rad/s";
  return fmt::format("1 [{}] is {:.6g} [{}]", wanted.text, 2 * std::numbers::pi * wanted.scale / given.scale, given.text);
}

}  // namespace

Diagnostic number_of_other_kind(Span span, Subject const& what, Unit const& given, Unit const& wanted) {
  return about(what.names,
               error("E2014", span, fmt::format("{} is {}, but this is {}", what.words, measure(wanted), measure(given)),
                     without_wrong_unit(given, wanted)));
}

Diagnostic number_in_cycles(Span span, Subject const& what, Unit const& given, Unit const& wanted) {
  return about(
      what.names,
      error("E4017", span,
            fmt::format("{} is {}, but this is {}: one counts cycles, the other radians, so they differ by a factor of 2 pi",
                        what.words, measure(wanted), measure(given)),
            fmt::format("give the number {}: {}", measure(wanted), cycles_in_words(given, wanted))));
}

}  // namespace sysid::errors
