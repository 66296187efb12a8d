// The checker's wording about implicit and differential-algebraic models.
#include <fmt/format.h>

#include "check/message/error_words.hpp"

namespace sysid::errors {

Diagnostic explicit_solver(Span option, std::string const& solver, Span equation, std::string const& unknown) {
  Diagnostic result{Severity::error,   "E3004", fmt::format("`{}` needs equations that can be solved for `{}`", solver, unknown),
                    Label{option, {}}, {},      fmt::format("use `solver = ida`, or solve the equation for `{}` by hand", unknown)};
  result.names = with_bare(unknown);
  result.names.push_back(solver);
  result.secondary.push_back({equation, fmt::format("not linear in `{}`", unknown)});
  return result;
}

namespace {

constexpr std::string_view other_solvers = "remove the option, or use `rk4`, `dopri5` or, if the model is stiff, `cvode`";

}  // namespace

Diagnostic solver_of_linear_equations(Span option, std::string const& solver, std::optional<Span> const& part, bool varies) {
  Diagnostic result{Severity::error,
                    "E3020",
                    varies ? fmt::format("`{}` needs linear equations whose coefficients are constant in time", solver)
                           : fmt::format("`{}` needs equations that are linear in the states", solver),
                    Label{option, {}},
                    {},
                    std::string(other_solvers)};
  result.names.push_back(solver);
  if (part) result.secondary.push_back({*part, varies ? "its coefficient changes in time" : "not linear"});
  return result;
}

Diagnostic solver_that_reads_no_time(Span option, std::string const& solver, std::string const& model) {
  return {
      Severity::error,
      "E3020",
      fmt::format("`{}` needs equations that do not depend on time, or only linearly, but those of `{}` depend on it nonlinearly",
                  solver, model),
      Label{option, {}},
      {},
      fmt::format("replace the term that depends on time by an input of the model; or {}", other_solvers),
      {solver, model}};
}

Diagnostic solver_of_few_states(Span option, std::string const& solver, std::string const& model, std::size_t states, int most) {
  return {Severity::error,   "E3020", fmt::format("`{}` is limited to {} states, but `{}` has {}", solver, most, model, states),
          Label{option, {}}, {},      std::string(other_solvers),
          {solver, model}};
}

Diagnostic input_of_exact_solver(Span input, std::string const& name, Span option, std::string const& solver, bool held) {
  Diagnostic result{
      Severity::error,
      "E3020",
      held ? fmt::format(
                 "`{0}` needs an input `{1}` that is constant between its samples, because `{1}` enters the equations nonlinearly",
                 solver, name)
           : fmt::format("`{}` needs an input `{}` that is constant or a straight line between its samples", solver, name),
      Label{input, {}},
      {},
      fmt::format("use another solver, or `hold = {}`", held ? "zero_order" : "linear")};
  result.names = {solver, name};
  result.secondary.push_back({option, "the solver"});
  return result;
}

Diagnostic constraint_of_input(ast::Equation const& equation, std::string const& input) {
  return {Severity::error,
          "E3015",
          fmt::format("this constraint prescribes a motion: the constraint force needs the second derivative of input `{}`", input),
          Label{equation.span, {}},
          {},
          fmt::format(
              "use the acceleration as the input: write `y'' = acceleration` here; or, if the constraint force is not "
              "needed, delete this "
              "line and the equation of motion that contains the force, and replace the state that this line prescribes by `{}`",
              input),
          with_bare(input)};
}

Diagnostic constraint_of_unknown(ast::Equation const& equation, std::string const& unknown) {
  return {Severity::error,
          "E3016",
          fmt::format("this equation must be differentiated in time, but `{}` in it has no derivative", unknown),
          Label{equation.span, {}},
          {},
          fmt::format("solve it for `{}` and write that as a definition: `let {} = ...`", unknown, unknown),
          with_bare(unknown)};
}

Diagnostic start_off_constraint(Span equation, Span initial) {
  Diagnostic result{Severity::error,
                    "E3017",
                    "the initial values do not satisfy this equation",
                    Label{equation, {}},
                    {},
                    "write the initial values as expressions of the parameters, so that this equation and its time derivative hold "
                    "for all values of the parameters"};
  result.secondary.push_back({initial, "given here"});
  return result;
}

Diagnostic start_not_used(Span initial, std::string const& unknown) {
  return about({unknown}, {Severity::warning,
                           "E3021",
                           fmt::format("this initial value is not used: the equations give `{}` another one at the start", unknown),
                           Label{initial, {}},
                           {},
                           fmt::format("remove it, and choose the initial values of the states from which `{}` follows", unknown),
                           {}});
}

Diagnostic estimated_start_of_constraint(Span start, Span equation) {
  Diagnostic result{Severity::error,  "E3018", "an estimated start would violate a constraint between the states",
                    Label{start, {}}, {},      "use `start = record`, with parameters for unknown initial values"};
  result.secondary.push_back({equation, "the constraint"});
  return result;
}

}  // namespace sysid::errors
