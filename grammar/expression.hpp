// Expressions, calls, units, declared names.
#pragma once
#include "grammar/token.hpp"

namespace sysid::grammar {

inline constexpr x3::rule<struct expression_tag, ast::Expression> expression = wanted::value;
/// name(arguments); fails where no parenthesis follows a name.
inline constexpr x3::rule<struct call_tag, ast::Call> call = "a function";
inline constexpr x3::rule<struct distribution_tag, ast::Call> distribution = "a distribution such as `normal(0, sd = 1)`";
/// `value`, `name = value`.
inline constexpr x3::rule<struct argument_tag, ast::Argument> argument = "an argument";
/// `[...]`.
inline constexpr x3::rule<struct unit_tag, ast::UnitExpression> unit = "a unit in brackets";
inline constexpr x3::rule<struct unit_expression_tag, ast::UnitExpression> unit_expression = "a unit";
/// A path, its index and its primes; the index stands directly behind the name, as the primes do.
inline constexpr x3::rule<struct reference_tag, ast::Reference> reference = wanted::name;
/// A name, its sizes and its unit.
inline constexpr x3::rule<struct declared_tag, ast::Declared> declared = wanted::name;
/// The same, with `per experiment` before the unit.
inline constexpr x3::rule<struct declared_parameter_tag, ast::Declared> declared_parameter = wanted::name;

BOOST_SPIRIT_DECLARE(decltype(expression), decltype(call), decltype(distribution), decltype(argument), decltype(unit),
                     decltype(unit_expression), decltype(reference), decltype(declared), decltype(declared_parameter))

}  // namespace sysid::grammar
