// The checker's wording about equations, initial values, channels, and names given twice.
#include <fmt/format.h>

#include <algorithm>

#include "check/message/error_words.hpp"
#include "syntax/foreign_words.hpp"

namespace sysid::errors {

Diagnostic state_without_equation(Span declaration, std::string const& state, std::string const& highest) {
  return about(
      {state},
      error(
          "E3001", declaration, fmt::format("state `{}` has no equation", state),
          fmt::format(
              "write the equation that contains {}; if it is a constraint force or another unknown without derivatives, use it in "
              "the equations of motion",
              highest)));
}

Diagnostic algebraic_state(Span declaration, std::string const& state) {
  return about(
      {state},
      error("E3002", declaration,
            fmt::format("nothing determines `{0}`: no equation contains `{0}'`, and no equation is left for `{0}`", state),
            fmt::format("add an equation for it; if it follows from other quantities, define it with `let {} = ...`", state)));
}

Diagnostic surplus_equation(ast::Equation const& equation, Names const& states) {
  return error("E3003", equation.span, "one equation too many: the others already determine every state",
               fmt::format("{} {}; delete this equation, or declare the state that it determines",
                           states.size() == 1 ? "the state is" : "the states are", quoted(states)));
}

Diagnostic undetermined(Span declaration, std::string const& unknown) {
  return about(with_bare(unknown), error("E3005", declaration, fmt::format("the equations do not determine `{}`", unknown),
                                         "the equations are linearly dependent in the highest derivatives: change one of them"));
}

Diagnostic initial_of_highest(ast::Reference const& reference, std::string const& state, int order, Names const& missing) {
  Names components;
  for (int k = 0; k < order; ++k) components.push_back(primed(state, k));
  return about(
      {primed(reference), state},
      error("E3006", reference.span, fmt::format("`{}` follows from the equations and takes no initial value", primed(reference)),
            missing.size() == 1
                ? fmt::format("`{}` is of order {}: give the initial value of `{}` in its place", state, order, missing.front())
                : fmt::format("`{}` is of order {}: give the initial values of {}", state, order, quoted(components))));
}

Diagnostic initial_missing(Span declaration, Names const& components, std::vector<StartValue> const& values) {
  bool const one = components.size() == 1;
  std::string written, as_zero;
  Names declarations;
  bool may_be_zero = false;
  for (std::size_t i = 0; i < components.size(); ++i) {
    written += fmt::format("{}{} = {}", i == 0 ? "" : ", ", components[i], values[i].value);
    as_zero += fmt::format("{}{} = {}", i == 0 ? "" : ", ", components[i], values[i].may_be_zero ? "0" : values[i].value);
    may_be_zero = may_be_zero || values[i].may_be_zero;
    std::string const& declaration = values[i].declaration;
    if (!declaration.empty() && std::find(declarations.begin(), declarations.end(), declaration) == declarations.end())
      declarations.push_back(declaration);
  }
  std::string help = fmt::format("write `initial {}`", written);
  if (!declarations.empty()) help += fmt::format(" and {}", quoted(declarations));
  if (may_be_zero) help += fmt::format("; or, of a difference of temperatures, `initial {}`", as_zero);
  return also_about(
      components,
      about({components.front().substr(0, components.front().find('\''))},
            error("E3007", declaration,
                  fmt::format("{} {} no initial value{}", quoted(components), one ? "has" : "have", one ? "" : "s"), help)));
}

Diagnostic initial_twice(Span second, Span first, std::string const& component) {
  return about(with_bare(component), conflict("E3008", second, "again here", first, "first given here",
                                              fmt::format("the initial value of `{}` is given twice", component), "keep one"));
}

Diagnostic initial_moves(Span span) {
  return error("E3009", span, "an initial value cannot depend on states, inputs or time", "use numbers, constants and parameters");
}

Diagnostic initial_from_channel(ast::Name const& channel, ast::Reference const& state, std::optional<Unit> const& unit) {
  std::string const name =
      state.name.text.substr(0, state.name.text.find('.')) + (state.primes == 0 ? "0" : fmt::format("_rate{}", state.primes));
  std::string const declared = unit && !unit->text.empty() ? fmt::format("{} [{}]", name, unit->text) : name;
  return about(
      {channel.text},
      error("E2001", channel.span,
            fmt::format("`{}` is a measured channel: its name alone cannot be used in an expression", channel.text),
            fmt::format("an unknown initial value is a parameter: `parameter {} ~ normal(0, sd = 1)` and `initial {} = {}`; or "
                        "the task estimates it from the first rows: `start = estimated(rows = 50)`",
                        declared, primed(state), name)));
}

Diagnostic not_a_state(ast::Name const& name, Names const& states, Names const& missing) {
  auto const refused = [&](std::string help) {
    return about({name.text}, error("E3010", name.span, fmt::format("`{}` is not a state", name.text), std::move(help)));
  };
  if (auto const derivative = words::as_derivative(name.text, states, true))
    return refused(fmt::format("a derivative is written with primes: `{}`", primed(derivative->of, derivative->primes)));
  for (std::string const& each : states)
    if (name.text == "v" + each) return refused(fmt::format("a derivative is written with primes: `{}'`", each));
  Diagnostic result =
      refused(guess_or(name.text, states,
                       missing.size() == 1 ? fmt::format("did you mean `{}`, which has no initial value yet?", missing[0])
                                           : choose(states, "state")));
  result.suggested = nearest(name.text, states);
  if (result.suggested.empty()) result.suggested = states;
  return result;
}

Diagnostic initial_of_input(ast::Name const& name) {
  return about(
      {name.text},
      error("E3010", name.span, fmt::format("`{}` is not a state but an input", name.text),
            fmt::format("declare it as `state {0}` if the equations determine it; an input has no initial value", name.text)));
}

Diagnostic channel_twice(ast::Name const& name, Span first) {
  return about({name.text}, conflict("E3011", name.span, "again here", first, "first observed here",
                                     fmt::format("channel `{}` is observed twice", name.text),
                                     "write one `observe` per channel; give a second sensor a channel of its own"));
}

Diagnostic nothing_observed(ast::Name const& model) {
  return about({model.text}, error("E3012", model.span, fmt::format("model `{}` observes nothing", model.text),
                                   "add an observation: `observe displacement ~ normal(y, sd = sigma)`"));
}

Diagnostic duplicate_item(ast::Name const& name, std::string const& kind, Span first) {
  return about({name.text}, conflict("E3013", name.span, "again here", first, "first here",
                                     fmt::format("there are two {}s named `{}`", kind, name.text), "rename one of the two"));
}

namespace {

char const* word(Declarer where) { return where == Declarer::dictionary ? "dictionary" : "model"; }

Diagnostic unused(Span declaration, std::string const& name, std::string message, std::string help) {
  return as_warning(about({name}, error("E3019", declaration, std::move(message), std::move(help))));
}

}  // namespace

Diagnostic unused_parameter(Span declaration, std::string const& parameter, bool has_prior, Declarer where) {
  return unused(declaration, parameter, fmt::format("nothing in this {} uses the parameter `{}`", word(where), parameter),
                where == Declarer::dictionary ? "use it as a factor of a term or in the target, or delete it"
                : has_prior ? "use it in an equation, an observation or another prior; otherwise its posterior equals its prior"
                            : "use it in an equation, an observation or a prior, or delete it");
}
Diagnostic unused_input(Span declaration, std::string const& input, Declarer where) {
  return unused(declaration, input, fmt::format("nothing in this {} uses the input `{}`", word(where), input),
                where == Declarer::dictionary
                    ? "use it in the target or in a term: an input that acts on the system but is left out remains in the residual"
                    : "use it in an equation or an observation, or delete it");
}

Diagnostic time_twice(Span second, Span first) {
  return conflict("E3014", second, "again here", first, "first declared here", "time is declared twice", "keep one");
}

}  // namespace sysid::errors
