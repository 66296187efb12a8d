// The statements of a model as displayed formulas: MathML for pages, LaTeX for papers.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "syntax/ast.hpp"

namespace sysid {

/// Whether print has a formula for it: not for inputs, states, time and parts, nor for a parameter that has neither prior nor
/// value.
bool has_formula(ast::ModelStatement const& statement);

/// Statements of one model as MathML, `<math display="block" alttext="...">`, their text in the language for readers of
/// alternatives; nothing where there is no formula.
std::vector<std::optional<std::string>> mathml(std::vector<ast::ModelStatement> const& statements);

/// The statement that a text is: "m*y'' + k*y = x", "observe force ~ normal(y, sd = s)". Nothing when it is none of a model.
std::optional<ast::ModelStatement> model_statement(std::string_view text);

/// The MathML of statements of one model that are given as texts, one each; empty where a text is none or has no formula.
std::vector<std::string> formulas(std::vector<std::string> const& statements);

/// An expression inside a line of a page.
std::string mathml(ast::Expression const& expression);

/// All that a model states, for amsmath: one `align*` with a line for each statement, in its order, as `m \, \ddot{y} + k \, y &=
/// x`, where `&` is what lines are aligned at. Equations, initial values, definitions and priors with their units, observations.
std::string latex(ast::Model const& model);

/// The models of a text, each behind a comment that names it.
std::string latex(ast::File const& file);

}  // namespace sysid
