// Definitions of the unit rules of expression.hpp: `[N s/m]`, `[1/m^2]`, `[N^(1-n)/m]`, `[-]`.
#pragma once
#include "grammar/actions.hpp"
#include "grammar/expression.hpp"

namespace sysid::grammar {

constexpr x3::rule<struct unit_content_tag, ast::UnitExpression> unit_content = "a unit";
constexpr x3::rule<struct dimensionless_tag, ast::UnitFactor> dimensionless = "a unit";
constexpr x3::rule<struct unit_factor_tag, ast::UnitFactor> unit_factor = "a unit";
/// The factor behind a `/`.
constexpr x3::rule<struct divisor_tag, ast::UnitFactor> divisor = "a unit";
constexpr x3::rule<struct unit_name_tag, ast::Name> unit_name = "a unit";
constexpr x3::rule<struct exponent_tag, ast::Expression> exponent = "an exponent";
constexpr x3::rule<struct negative_exponent_tag, ast::Unary> negative_exponent = "an exponent";
constexpr x3::rule<struct exponent_magnitude_tag, ast::Expression> exponent_magnitude = "an exponent";
constexpr x3::rule<struct closing_bracket_tag> closing_bracket = "`]`";

constexpr auto name_itself(char const* spelling) {
  return [spelling](auto& context) { x3::_val(context).text = spelling; };
}
constexpr auto no_dimension = [](auto& context) { x3::_val(context).base = ast::Name{{}, "-"}; };
constexpr auto take_reciprocal = [](auto& context) {
  x3::_val(context) = std::move(x3::_attr(context));
  x3::_val(context).reciprocal = true;
};

auto const unit_def = '[' > unit_content[take] > closing_bracket;
auto const closing_bracket_def = x3::lit(']');
auto const unit_content_def = located[dimensionless[append(&ast::UnitExpression::factors)] | unit_expression[take]];
auto const dimensionless_def = located[x3::lit('-')[no_dimension]];

auto const unit_expression_def =
    located[unit_factor[append(&ast::UnitExpression::factors)] >>
            *(divisor[append(&ast::UnitExpression::factors)] | ('*' > unit_factor[append(&ast::UnitExpression::factors)]) |
              unit_factor[append(&ast::UnitExpression::factors)])];
auto const divisor_def = '/' > unit_factor[take_reciprocal];
auto const unit_factor_def =
    located[(unit_name[to(&ast::UnitFactor::base)] | ('(' > nested[unit_expression][to(&ast::UnitFactor::base)] > ')')) >>
            -('^' > exponent[to(&ast::UnitFactor::exponent)])];
// No number: `1e3N` is not 1 e3N.
auto const one = x3::lexeme['1' >> !(digit | '.' | (x3::char_("eE") >> -x3::char_("+-") >> digit))];
auto const unit_name_def = located[name[take] | one[name_itself("1")] | x3::lit('%')[name_itself("%")]];

// No unit may follow the number of an exponent, and no call its name: `[N^n (m s)]` is a product.
auto const exponent_def = located[negative_exponent[take_boxed] | exponent_magnitude[take]];
auto const negative_exponent_def = located[x3::lit('-')[symbol("-")] > exponent_magnitude[to(&ast::Unary::operand)]];
auto const exponent_magnitude_def =
    located[plain_number[take_node] | reference[take_node] | ('(' > nested[expression][take] > ')')];

BOOST_SPIRIT_DEFINE(unit, closing_bracket, unit_content, dimensionless, unit_expression, divisor, unit_factor, unit_name, exponent,
                    negative_exponent, exponent_magnitude)

}  // namespace sysid::grammar
