// The checker's wording about priors and noise.
#include <fmt/format.h>

#include <algorithm>

#include "check/message/error_words.hpp"
#include "core/text/words.hpp"
#include "syntax/grouped_digits.hpp"
#include "syntax/unparse.hpp"

namespace sysid::errors {
namespace {

/// `0,5` up to `last`, two arguments for what may be one number: how it is written with a point, or empty.
std::string decimal_comma(ast::Call const& call, ast::Argument const& last) {
  for (std::size_t i = 1; i < call.arguments.size() && &call.arguments[i - 1] != &last; ++i) {
    ast::Argument const &left = call.arguments[i - 1], &right = call.arguments[i];
    std::string const whole = whole_digits(left), fraction = right.name ? std::string() : whole_digits(right);
    if (whole.empty() || fraction.empty() || left.span.end + 1 != right.span.begin) continue;
    std::string const decimal = fmt::format("write the number with a decimal point: `{}.{}`", whole, fraction);
    return continues_group(whole, false, fraction)
               ? fmt::format("digits are not grouped: write `{}{}`; {}", whole, fraction, decimal)
               : decimal;
  }
  return {};
}

/// `exponential(0.01)` of Stan, where the argument is a rate and here a mean could be meant.
std::string or_rate(Names const& spellings, std::string const& value) {
  bool const has_rate = std::find(spellings.begin() + 1, spellings.end(), "rate") != spellings.end();
  return has_rate ? fmt::format(", or `rate = {}` if it is a rate, as in Stan", value) : std::string();
}

/// `0.01^2` as the second argument of a normal distribution is a variance, as in most books, and `1/0.01^2` a precision.
std::string by_its_form(Names const& spellings, ast::Expression const& value) {
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&value.node);
  auto const* above = binary == nullptr || (*binary)->symbol != "/" ? nullptr : std::get_if<ast::Number>(&(*binary)->left->node);
  bool const quotient = above != nullptr && above->value == 1 && !above->unit;
  if (quotient) binary = std::get_if<ast::Box<ast::Binary>>(&(*binary)->right->node);
  auto const* exponent = binary == nullptr ? nullptr : std::get_if<ast::Number>(&(*binary)->right->node);
  bool const square = exponent != nullptr && (*binary)->symbol == "^" && exponent->value == 2 && !exponent->unit;
  std::string const meant = quotient ? "precision" : "variance";
  return square && std::find(spellings.begin(), spellings.end(), meant) != spellings.end() ? meant : spellings.front();
}

/// The call with its arguments in another order.
std::string with_arguments(ast::Call const& call, std::vector<std::size_t> const& order) {
  std::string text = call.function.text + "(";
  for (std::size_t i = 0; i < order.size(); ++i) {
    ast::Argument const& argument = call.arguments[order[i]];
    text += (i == 0 ? "" : ", ") + (argument.name ? argument.name->text + " = " : "") + unparse(argument.value);
  }
  return text + ")";
}

}  // namespace

Diagnostic argument_twice(Span second, Span first, std::string const& spelling, std::string const& other) {
  if (spelling == other)
    return about({spelling}, conflict("E2104", second, "again here", first, "first given here",
                                      fmt::format("`{}` is given twice", spelling), "keep one"));
  return about({other, spelling}, conflict("E2104", second, fmt::format("`{}`", spelling), first, fmt::format("`{}`", other),
                                           fmt::format("`{}` and `{}` are two forms of the same argument", other, spelling),
                                           "keep one: precision = 1/variance, variance = sd^2"));
}

namespace {

/// A number of 1 or more without a name and a unit; a name or a small number is likelier a width.
bool may_be_degrees_of_freedom(ast::Argument const& argument) {
  auto const* number = std::get_if<ast::Number>(&argument.value.node);
  return !argument.name && number != nullptr && !number->unit && number->value >= 1;
}

/// `student_t(y, sigma)`, `student_t(y, sd = sigma)`: the second argument is what few expect.
std::string with_degrees_of_freedom(ast::Call const& call) {
  if (call.function.text != "student_t" || call.arguments.size() != 2 || call.arguments[0].name) return {};
  ast::Argument width = call.arguments[1];
  if (width.name && width.name->text == "degrees_of_freedom") return {};
  if (may_be_degrees_of_freedom(width))
    return fmt::format("its width comes after the degrees of freedom: write `student_t({}, {}, scale = ...)`",
                       unparse(call.arguments[0].value), unparse(width.value));
  if (!width.name) width.name = ast::Name{call.span, "scale"};
  return fmt::format("the degrees of freedom come second, 1 for a Cauchy distribution: write `student_t({}, 4, {} = {})`",
                     unparse(call.arguments[0].value), width.name->text, unparse(width.value));
}

}  // namespace

Diagnostic argument_missing(ast::Call const& call, Names const& spellings) {
  std::string const whole = with_degrees_of_freedom(call);
  return also_about(spellings,
                    about({call.function.text},
                          error("E2105", call.span, fmt::format("`{}` needs {}", call.function.text, quoted(spellings, "or")),
                                whole.empty() ? fmt::format("write for example `{} = ...`", spellings.front()) : whole)));
}

Diagnostic must_be_named(ast::Call const& call, ast::Argument const& argument, Names const& spellings, std::string const& first) {
  std::string const point = decimal_comma(call, argument);
  return also_about(
      spellings,
      about({call.function.text},
            error("E2106", argument.span, fmt::format("the name of this argument is missing: {}", quoted(spellings, "or")),
                  fmt::format("{}write `{} = {}`{}{}", point.empty() ? "" : point + "; if the comma separates arguments, ",
                              by_its_form(spellings, argument.value), unparse(argument.value),
                              or_rate(spellings, unparse(argument.value)), first.empty() ? "" : "; " + first))));
}

Diagnostic range_in_distribution(ast::Call const& call, ast::Expression const& range, bool bounds, bool truncates) {
  ast::Binary const& ends = *std::get<ast::Box<ast::Binary>>(range.node);
  std::string const lower = unparse(*ends.left), upper = unparse(*ends.right);
  return about({call.function.text},
               error("E3112", range.span, "a range is not allowed here",
                     bounds      ? fmt::format("write the bounds as two arguments: `{}({}, {})`", call.function.text, lower, upper)
                     : truncates ? fmt::format("write the bounds as two arguments: `lower = {}, upper = {}`", lower, upper)
                                 : fmt::format("a prior between two bounds is written `uniform({}, {})`", lower, upper)));
}

Diagnostic place_of_half(ast::Call const& call, std::string const& width) {
  std::vector<std::size_t> rest;
  for (std::size_t i = 1; i < call.arguments.size(); ++i) rest.push_back(i);
  return about({call.function.text},
               error("E2107", call.arguments.front().span,
                     fmt::format("`{}` begins at 0 and takes no location: its argument is `{}`", call.function.text, width),
                     fmt::format("write `{}`", with_arguments(call, rest))));
}

Diagnostic degrees_of_freedom_first(ast::Call const& call) {
  std::vector<std::size_t> order{1, 0};
  for (std::size_t i = 2; i < call.arguments.size(); ++i) order.push_back(i);
  ast::Call named = call;
  // A third argument has its name.
  if (named.arguments.size() > 2 && !named.arguments[2].name) named.arguments[2].name = ast::Name{call.span, "scale"};
  return also_about({"degrees_of_freedom", "location"},
                    about({call.function.text},
                          error("E2106", call.arguments.front().span,
                                fmt::format("the location of `{}` comes first, then the degrees of freedom", call.function.text),
                                fmt::format("write `{}`", with_arguments(named, order)))));
}

Diagnostic logarithm_or_number(ast::Argument const& argument, std::string const& written, std::string const& distribution) {
  std::string const value = unparse(argument.value);
  return also_about(
      {"median", "log_mean"},
      about({distribution},
            error("E2106", argument.span,
                  fmt::format("without a name this is the median of `{}`, but it is written as a logarithm", distribution),
                  fmt::format("write `{}` if `{}` is the mean of the logarithm; `median = {}` if it is the median", written, value,
                              value))));
}

Diagnostic logarithm_of_shifted(Span span, std::string const& spelling, std::string const& distribution) {
  return about(
      {distribution, spelling},
      error("E2112", span,
            fmt::format(
                "`{}` of `{}` cannot be given: a temperature in [degC] or [degF] has no logarithm, because its zero is arbitrary",
                spelling, distribution),
            "give the median, which is not a logarithm: `median = 20 [degC]`; or declare the parameter in [K]"));
}

Diagnostic too_many_arguments(ast::Call const& call, ast::Argument const& argument, Names const& signature) {
  std::string const point = decimal_comma(call, argument);
  return about({call.function.text},
               error("E2107", argument.span, fmt::format("`{}` does not take this many arguments", call.function.text),
                     (point.empty() ? "" : point + "; ") +
                         (signature.empty() ? "it takes none"
                                            : fmt::format("{} {}", signature.size() == 1 ? "its argument is" : "its arguments are",
                                                          quoted(signature)))));
}

Diagnostic not_a_noise(ast::Call const& call, Names const& known) {
  return about({call.function.text},
               error("E2108", call.function.span, fmt::format("`{}` cannot be the noise of a channel", call.function.text),
                     fmt::format("use {}", quoted(known, "or"))));
}

Diagnostic truncated_noise(ast::Call const& call) {
  return error("E2116", call.span, "the noise of a channel cannot be truncated",
               "remove `lower` and `upper`; bound the parameters instead");
}

Diagnostic cannot_truncate(Span span, std::string const& distribution) {
  return about({distribution},
               error("E2109", span, fmt::format("`{}` cannot be truncated", distribution), "remove `lower` and `upper`"));
}

Diagnostic prior_reads(Span span, std::string const& parameter, std::string const& what) {
  return about({parameter}, error("E2110", span, fmt::format("the prior of `{}` depends on {}", parameter, what),
                                  "a prior can use numbers, constants and other parameters"));
}

Diagnostic prior_cycle(Span span, Names const& loop) {
  return error("E2111", span, fmt::format("these priors depend on each other in a cycle: {}", fmt::join(loop, " -> ")),
               "write one of them without the others");
}

Diagnostic bad_arguments(Span span, std::string const& distribution, std::string_view reason, std::string help) {
  return about({distribution}, error("E2112", span, fmt::format("the arguments of `{}` are invalid: {}", distribution, reason),
                                     help.empty() ? "choose arguments that satisfy this condition" : std::move(help)));
}

Diagnostic never_allowed(Span span, std::string const& distribution, std::string const& variate, std::string_view reason,
                         std::vector<std::string> const& names) {
  return about({distribution, variate},
               error("E2112", span,
                     fmt::format("`{}` of `{}` has invalid arguments for all values that the priors allow: {}", distribution,
                                 variate, reason),
                     positive_prior(names)));
}

Diagnostic width_below_zero(Span parameter, std::string const& name, std::string const& argument, std::string const& of) {
  return as_warning(
      about({name, of},
            error("E2120", parameter,
                  fmt::format("`{}`, the {} of `{}`, must be positive, but its prior also has negative values", name, argument, of),
                  "add `lower = 0` to this prior, or use a prior of positive values, such as `half_normal(sd = ...)`")));
}

Diagnostic wide_logarithm(Span width, std::string const& distribution, std::string const& spelling, std::string const& written) {
  return as_warning(
      about({distribution},
            error("E2121", width,
                  fmt::format("`{} = {}` of `{}` is that of the natural logarithm: a factor of more than 20000 in either direction",
                              spelling, written, distribution),
                  "10 % is `sd = 0.1`, a factor of 2 `sd = 0.7`; a width in the unit of the quantity is that of `normal`")));
}

Diagnostic angle_in_other_unit(Span argument, std::string const& text, std::string const& name, std::string const& unit,
                               std::string const& meant) {
  return as_warning(
      about({name}, error("E2213", argument, fmt::format("`{}` is in [{}], as `{}` is", text, unit, name),
                          fmt::format("if it is in [{0}], declare `{1}` in [{0}]; equations need no change", meant, name))));
}

Diagnostic no_mass(Span span, std::string const& distribution) {
  return about({distribution}, error("E2115", span, fmt::format("`{}` has no probability between its bounds", distribution),
                                     "widen `lower` and `upper`, or move the distribution"));
}

Diagnostic unit_of_share(Span span, std::string const& distribution, std::string const& unit) {
  return about(
      {distribution},
      error("E2117", span, fmt::format("`{}` is a distribution of pure numbers, but this quantity is in [{}]", distribution, unit),
            fmt::format("give this prior to a dimensionless factor and multiply it by a quantity in [{}]", unit)));
}

Diagnostic unit_of_count(Span span, std::string const& distribution, std::string const& unit) {
  return about(
      {distribution},
      error("E2118", span, fmt::format("`{}` is a distribution of counts, but this quantity is in [{}]", distribution, unit),
            "a count is a pure number: divide the expression by the size of one item, and remove the unit of the channel"));
}

Diagnostic count_as_prior(ast::Call const& call) {
  return about(
      {call.function.text},
      error("E2119", call.function.span,
            fmt::format("`{}` is a distribution of counts: it can be the noise of a channel, but not a prior", call.function.text),
            "use a continuous prior, such as gamma or log_normal"));
}

Diagnostic noise_of_counts(Span span, std::string const& channel, std::string const& distribution) {
  return about({channel}, error("E6015", span,
                                fmt::format("channel `{}` measures counts: noise in percent would not give whole numbers", channel),
                                fmt::format("write `noise = model`: the counts are then drawn from `{}`", distribution)));
}

Diagnostic no_prior_or_value(ast::ParameterDeclaration const& parameter) {
  std::string const& name = parameter.name.name.text;
  return about({name}, error("E2113", parameter.name.span, fmt::format("parameter `{}` has neither a prior nor a value", name),
                             fmt::format("give a prior, `parameter {} ~ log_uniform(0.1, 10)`, or a value, `parameter {} = 1`",
                                         name, name)));
}

Diagnostic shared_prior_reads_own(Span prior, std::string const& parameter, std::string const& own) {
  return about(
      {parameter, own},
      error("E6305", prior,
            fmt::format("the prior of `{}`, which all experiments share, depends on `{}`, which is per experiment", parameter, own),
            fmt::format("declare `{}` as `per experiment` too, or let `{}` refer to `{}`: `parameter {} per experiment ~ "
                        "normal({}, sd = ...)`",
                        parameter, own, parameter, own, parameter)));
}

}  // namespace sysid::errors
