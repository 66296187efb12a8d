// Unit expressions of the syntax tree to units; and what the checker knows of the unit of an expression.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "core/diagnostic.hpp"
#include "core/unit.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// Names that stand for whole numbers known when a model is used: the n of `model bouc_wen(n)`.
using WholeNumbers = std::map<std::string, int>;

/// The unit written between brackets, with its text as the user wrote it; nothing (and a diagnostic) for an unknown atom or an
/// exponent that is not made of numbers and `known` names.
std::optional<Unit> check_unit(ast::UnitExpression const& expression, Diagnostics& diagnostics, WholeNumbers const& known = {});
std::optional<Unit> check_unit(std::optional<ast::UnitExpression> const& expression, Diagnostics& diagnostics,
                               WholeNumbers const& known = {});
/// A declared unit of time measures time.
void check_time_unit(std::optional<Unit> const& unit, Span span, Diagnostics& diagnostics);

}  // namespace sysid
