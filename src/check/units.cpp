// Unit expressions: products of atoms and groups with constant rational exponents.
#include "check/units.hpp"

#include <cmath>

#include "check/errors.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

std::optional<double> constant_exponent(ast::Expression const& expression, WholeNumbers const& known) {
  if (auto const* number = std::get_if<ast::Number>(&expression.node))
    return number->unit ? std::nullopt : std::optional(number->value);
  if (auto const* reference = std::get_if<ast::Reference>(&expression.node)) {
    auto const place = known.find(reference->name.text);
    return reference->primes > 0 || place == known.end() ? std::nullopt : std::optional<double>(place->second);
  }
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&expression.node)) {
    auto const operand = constant_exponent(*(*unary)->operand, known);
    if (!operand || (*unary)->symbol != "-") return std::nullopt;
    return -*operand;
  }
  if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&expression.node)) {
    auto const a = constant_exponent(*(*binary)->left, known), b = constant_exponent(*(*binary)->right, known);
    if (!a || !b) return std::nullopt;
    std::string const& symbol = (*binary)->symbol;
    if (symbol == "+") return *a + *b;
    if (symbol == "-") return *a - *b;
    if (symbol == "*") return *a * *b;
    if (symbol == "/") return *a / *b;
  }
  return std::nullopt;
}

std::optional<Unit> product(ast::UnitExpression const& expression, Diagnostics& diagnostics, WholeNumbers const& known) {
  Unit result;
  bool good = true;
  bool const alone = expression.factors.size() == 1;
  for (ast::UnitFactor const& factor : expression.factors) {
    std::optional<Unit> base;
    if (auto const* name = std::get_if<ast::Name>(&factor.base)) {
      base = unit_atom(name->text);
      if (!base) diagnostics.add(errors::unknown_unit(*name));
    } else {
      base = product(*std::get<ast::Box<ast::UnitExpression>>(factor.base), diagnostics, known);
    }
    if (!base) {
      good = false;
      continue;
    }
    if (factor.exponent) {
      auto const exponent = constant_exponent(**factor.exponent, known);
      auto const rational = exponent ? to_rational(*exponent) : std::nullopt;
      if (!rational) {
        diagnostics.add(errors::unit_exponent((*factor.exponent)->span));
        good = false;
        continue;
      }
      base = power(*base, *rational);
    }
    // A temperature keeps its zero only when it stands alone; in a product it is a difference.
    if (alone && !factor.exponent && !factor.reciprocal)
      result = *base;
    else
      result = factor.reciprocal ? divide(result, *base) : multiply(result, *base);
  }
  if (!good) return std::nullopt;
  return result;
}

// The unit as it is for these whole numbers: [N^(1-n)/m] is shown as [N^(-1)/m] where n is 2.
ast::UnitExpression with_numbers(ast::UnitExpression expression, WholeNumbers const& known) {
  for (ast::UnitFactor& factor : expression.factors) {
    if (auto* group = std::get_if<ast::Box<ast::UnitExpression>>(&factor.base)) *group = with_numbers(std::move(**group), known);
    if (!factor.exponent || constant_exponent(**factor.exponent, {})) continue;
    auto const value = constant_exponent(**factor.exponent, known);
    if (!value) continue;
    ast::Number magnitude;
    magnitude.value = std::fabs(*value);
    ast::Expression number;
    number.node = magnitude;
    if (*value < 0) {
      ast::Unary negative;
      negative.symbol = "-";
      *negative.operand = number;
      number.node = ast::Box<ast::Unary>(std::move(negative));
    }
    factor.exponent = ast::Box<ast::Expression>(std::move(number));
  }
  return expression;
}

}  // namespace

std::optional<Unit> check_unit(ast::UnitExpression const& expression, Diagnostics& diagnostics, WholeNumbers const& known) {
  std::optional<Unit> unit = product(expression, diagnostics, known);
  if (unit) unit->text = unparse(known.empty() ? expression : with_numbers(expression, known));
  if (unit && unit->text.size() > 1 && unit->text.front() == '[') unit->text = unit->text.substr(1, unit->text.size() - 2);
  return unit;
}

std::optional<Unit> check_unit(std::optional<ast::UnitExpression> const& expression, Diagnostics& diagnostics,
                               WholeNumbers const& known) {
  return expression ? check_unit(*expression, diagnostics, known) : std::nullopt;
}

void check_time_unit(std::optional<Unit> const& unit, Span span, Diagnostics& diagnostics) {
  if (unit && unit->dimension != unit_atom("s").value().dimension) diagnostics.add(errors::not_a_time(span, *unit));
}

}  // namespace sysid
