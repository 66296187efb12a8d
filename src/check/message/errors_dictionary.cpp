// The checker's wording about dictionaries and discovery.
#include <fmt/format.h>

#include "check/message/error_words.hpp"
#include "function/table.hpp"
#include "syntax/unparse.hpp"

namespace sysid::errors {
namespace {

std::string units(Names const& all) {
  std::string text;
  for (std::string const& each : all) text += fmt::format("{}[{}]", text.empty() ? "" : ", ", each);
  return text;
}

}  // namespace

Diagnostic no_target(ast::Name const& dictionary) {
  return about({dictionary.text}, error("E6601", dictionary.span, fmt::format("dictionary `{}` has no target", dictionary.text),
                                        "add `target = m*y'' - x`, or a derivative for each equation: `target = x', y'`"));
}

Diagnostic target_twice(Span second, Span first, std::string const& text) {
  return about({text}, conflict("E6613", second, "again here", first, "first here", fmt::format("`{}` is a target twice", text),
                                "remove one of the two: each target has an equation of its own"));
}

Diagnostic target_among_terms(Span target, Span term, std::string const& text, std::string const& written,
                              std::string const& derivative) {
  std::string const message =
      written == text ? fmt::format("`{0}` is both the target and a term: `{0} = 1*{0}` is always right and explains nothing", text)
                      : fmt::format("the term `{}` is the target `{}` but for a factor: it is always right and explains nothing",
                                    written, text);
  std::string const rate =
      derivative.empty() ? "" : fmt::format("if the rate of change is meant, write `target = {}`; else ", derivative);
  return about({text, written}, conflict("E6618", term, "a term", target, "the target", message,
                                         fmt::format("{}leave this term out: `exclude = {}`", rate, written)));
}

Diagnostic no_terms(ast::Name const& dictionary) {
  return about({dictionary.text}, error("E6602", dictionary.span, fmt::format("dictionary `{}` has no terms", dictionary.text),
                                        "add `terms = polynomial(y, y', degree = 3), abs(y')*y', 1`"));
}

Diagnostic nothing_left_of_terms(Span target, std::string const& equation) {
  return about({equation}, error("E6602", target, fmt::format("no term remains for `{}`", equation),
                                 "allow more units in `coefficients`, exclude fewer terms, or add terms"));
}

Diagnostic family_inside_term(ast::Name const& family, ast::Expression const& item) {
  std::string terms;
  ast::Expression const* rest = &item;
  for (auto const* sum = std::get_if<ast::Box<ast::Binary>>(&rest->node); sum != nullptr && (*sum)->symbol == "+";
       sum = std::get_if<ast::Box<ast::Binary>>(&rest->node)) {
    terms = fmt::format(", {}{}", unparse(*(*sum)->right), terms);
    rest = &*(*sum)->left;
  }
  return about({family.text}, error("E6603", family.span, fmt::format("`{}` is a family of terms, not a function", family.text),
                                    terms.empty() ? "a family stands alone in the list of terms, or is a factor of a product"
                                                  : fmt::format("separate terms by commas: `{}{}`", unparse(*rest), terms)));
}

Diagnostic list_of_terms(std::string const& statement, ast::Expression const& list) {
  std::string const text = unparse(list);
  return error("E2013", list.span, "a list cannot be used in an expression",
               fmt::format("write it without parentheses: `{} = {}`", statement, text.substr(1, text.size() - 2)));
}

Diagnostic unknown_generator(ast::Name const& name, Names const& families) {
  Names known = families;
  for (FunctionRow const& row : functions()) known.emplace_back(row.name);
  return about({name.text}, error("E6603", name.span, fmt::format("there is no family of terms and no function `{}`", name.text),
                                  guess_or(name.text, known, fmt::format("families: {}", quoted(families)))));
}

Diagnostic generator_arguments(ast::Name const& generator, std::string const& missing, std::string const& example) {
  return about({generator.text, missing},
               error("E6603", generator.span,
                     fmt::format("`{}` needs {}", generator.text, missing == "arguments" ? missing : "`" + missing + "`"),
                     fmt::format("for example `{}`", example)));
}

Diagnostic generator_number(Span span, std::string const& option, int most, std::string const& example) {
  return about({option}, error("E6603", span, fmt::format("`{}` must be a whole number from 1 to {}", option, most),
                               fmt::format("for example `{}`", example)));
}

Diagnostic target_not_linear(Span target, std::string const& text, Names const& parameters) {
  return also_about(parameters,
                    about({text}, error("E6604", target,
                                        fmt::format("`{}` is not linear in {}, which {} no value", text, quoted(parameters),
                                                    parameters.size() == 1 ? "has" : "have"),
                                        "an unknown parameter must be a factor of a term: `m*y'' - x`; every other parameter "
                                        "needs a value: `parameter NAME = 1`")));
}

Diagnostic coefficient_of_two_targets(Span target, std::string const& parameter) {
  return about({parameter}, error("E6604", target,
                                  fmt::format("`{}` occurs in two targets, but each equation is estimated separately", parameter),
                                  "use a separate parameter in each target, or give this one a value"));
}

Diagnostic coefficient_inside(Span term, std::string const& text) {
  return about({text}, error("E6605", term, fmt::format("`{}` is not linear in a parameter that has no value", text),
                             "a term has at most one parameter without a value, as a factor: `k*y`; give every other parameter a "
                             "value, or a prior: it is then "
                             "estimated inside the term"));
}

Diagnostic inner_prior(Span prior, std::string const& parameter, std::string const& why) {
  return about({parameter}, error("E6617", prior, fmt::format("the prior of `{}` {}", parameter, why),
                                  "the value of a parameter inside a term is searched within its prior: give it a proper prior "
                                  "whose arguments are numbers, such as `uniform(0, 1)` or `log_uniform(0.01, 10)`"));
}

Diagnostic inner_scales(Span term, std::string const& text, std::string const& parameter, std::string const& declared) {
  return about({text, parameter},
               error("E6617", term, fmt::format("`{}` only scales `{}`, which already has an unknown coefficient", parameter, text),
                     fmt::format("declare `parameter {}` without a prior, or leave it out of the term", declared)));
}

Diagnostic inner_in_target(Span target, std::string const& text, std::string const& parameter, std::string const& declared) {
  return about({text, parameter},
               error("E6617", target, fmt::format("`{}` has a prior, but is used in the target `{}`", parameter, text),
                     fmt::format("a parameter with a prior can be used only inside terms; for the target declare `parameter {}` "
                                 "without a prior and use it as a "
                                 "factor, or give it a value",
                                 declared)));
}

Diagnostic state_without_channel(Span state, std::string const& name) {
  return about({name}, error("E6606", state, fmt::format("no channel measures `{}` or a derivative of it", name),
                             fmt::format("assign a channel to it: `state {} = CHANNEL`; discovery needs measured states", name)));
}

Diagnostic derivative_of_nothing(ast::Name const& state, int primes) {
  return about({primed(state.text, primes), state.text},
               error("E6607", state.span,
                     fmt::format("`{}` is assigned to a channel before `{}` is declared", primed(state.text, primes), state.text),
                     fmt::format("declare the state first: `state {}, {} = CHANNEL`", state.text, primed(state.text, primes))));
}

Diagnostic derivative_without_channel(ast::Name const& state, int primes) {
  return about(
      {primed(state.text, primes), state.text},
      error("E6607", state.span, fmt::format("`{}` has no channel here", primed(state.text, primes)),
            fmt::format("write `{} = CHANNEL`, or remove it: derivatives need no declaration", primed(state.text, primes))));
}

Diagnostic channel_bound_twice(ast::Name const& channel, Span first) {
  return about({channel.text}, conflict("E6607", channel.span, "and here", first, "here",
                                        fmt::format("channel `{}` is assigned twice", channel.text),
                                        "a channel measures one state, or one derivative of it"));
}

Diagnostic excludes_nothing(Span span, std::string const& text, Names const& known) {
  return about({text}, error("E6608", span, fmt::format("`{}` is not a term of this dictionary", text),
                             guess_or(text, known, "remove it here; `sysid check` lists the terms")));
}

Diagnostic unit_of_no_term(Span span, std::string const& unit, Names const& possible) {
  return error("E6609", span, fmt::format("no term has a coefficient in [{}]", unit.empty() ? "-" : unit),
               possible.empty()
                   ? std::string("declare the units of states, inputs and parameters: the units of coefficients follow from them")
                   : fmt::format("the coefficients of the terms are in {}", units(possible)));
}

Diagnostic too_many_terms(Span span, std::size_t most) {
  return error("E6610", span, fmt::format("the dictionary has more than {} terms", most), "reduce a degree, or list single terms");
}

Diagnostic index_in_dictionary(ast::Reference const& reference) {
  return about({reference.name.text},
               error("E6611", reference.span,
                     fmt::format("`{}` has no elements: quantities of a dictionary are scalars", reference.name.text),
                     "give each element a name: `state y1 = a[1], y2 = a[2]`"));
}

Diagnostic target_of_discrete_time(Span target, std::string const& text, std::string const& state) {
  return about({text},
               error("E6614", target, fmt::format("`{}` is not a state: in discrete time a target is a state", text),
                     fmt::format("write `target = {0}`, the present sample; its past is in the terms: `lag({0}, 1)`", state)));
}

Diagnostic present_in_term(Span term, std::string const& text, std::string const& state) {
  return about({text, state},
               error("E6614", term, fmt::format("term `{}` uses the present sample of `{}`, which is the target", text, state),
                     fmt::format("use the samples before it: `lag({0}, 1)`, `lags({0}, 1..2)`", state)));
}

Diagnostic state_without_target(Span state, std::string const& name) {
  return about({name}, error("E6615", state, fmt::format("no target gives `{}` at the present sample", name),
                             fmt::format("add it to the targets, or declare it as an input: `input {}`", name)));
}

Diagnostic not_in_discrete_time(Span option, std::string const& name, std::string const& dictionary) {
  return about(
      {name, dictionary},
      error("E6616", option, fmt::format("dictionary `{}` is in discrete time: `{}` has no meaning there", dictionary, name),
            "remove it: terms are formed from samples, and the noise is estimated with them"));
}

Diagnostic channel_not_measured(Span data, std::string const& block, Span state, std::string const& channel,
                                Names const& measured) {
  Diagnostic result = about(
      {block, channel}, error("E6612", data, fmt::format("data block `{}` does not measure `{}`", block, channel),
                              guess_or(channel, measured, fmt::format("add `measure {} = COLUMN` to the data block", channel))));
  result.secondary.push_back({state, "assigned here"});
  return result;
}

}  // namespace sysid::errors
