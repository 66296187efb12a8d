// The statements of a model as displayed formulas: MathML for pages, LaTeX for papers.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "syntax/ast.hpp"

namespace sysid {

/// Whether print has a formula for it: not for inputs, states, time and parts, nor for a parameter that has neither prior nor
/// value.
bool has_formula(ast::ModelStatement const& statement);

/// A statement as MathML, `<math display="block" alttext="...">`, its text in the language for readers of alternatives; nothing
/// where there is no formula.
std::optional<std::string> mathml(ast::ModelStatement const& statement);

/// Of a text: "m*y'' + k*y = x", "observe force ~ normal(y, sd = s)". Nothing when it is no statement of a model, or shows no
/// formula.
std::optional<std::string> mathml(std::string_view statement);

/// An expression inside a line of a page.
std::string mathml(ast::Expression const& expression);

/// A statement as LaTeX, for amsmath, without an environment around it: `m \, \ddot{y} + k \, y &= x`, where `&` is what lines are
/// aligned at.
std::optional<std::string> latex(ast::ModelStatement const& statement);

/// All that a model states, as one `align*` with a line for each statement, in its order: equations, initial values, definitions,
/// observations, priors with their units.
std::string latex(ast::Model const& model);

}  // namespace sysid
