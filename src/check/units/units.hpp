// Unit expressions of the syntax tree to units; and the unit of an expression as far as the checker can determine it.
#pragma once
#include <optional>

#include "check/message/subject.hpp"
#include "core/numeric/unit.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// The unit written between brackets, with its text as the user wrote it; nothing (and a diagnostic) for an unknown atom or a
/// non-constant exponent.
std::optional<Unit> check_unit(ast::UnitExpression const& expression, Diagnostics& diagnostics);
std::optional<Unit> check_unit(std::optional<ast::UnitExpression> const& expression, Diagnostics& diagnostics);
/// What forbids a number in unit `given` where one in `wanted` is meant: another kind of quantity, a temperature for a difference
/// of two, cycles for radians. what: errors::named("rate").
std::optional<Diagnostic> refuse_number(Span span, errors::Subject const& what, Unit const& given, Unit const& wanted);
/// 45, 90, 180, 270, 360: a bare number that is one of degrees wherever angles are meant.
bool is_usual_in_degrees(double number);
/// A declared unit of time measures time.
void check_time_unit(std::optional<Unit> const& unit, Span span, Diagnostics& diagnostics);

}  // namespace sysid
