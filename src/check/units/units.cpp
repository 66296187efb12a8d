// Unit expressions: products of atoms and groups with constant rational exponents.
#include "check/units/units.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "check/message/errors.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

std::optional<double> constant_exponent(ast::Expression const& expression) {
  if (auto const* number = std::get_if<ast::Number>(&expression.node))
    return number->unit ? std::nullopt : std::optional(number->value);
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&expression.node)) {
    auto const operand = constant_exponent(*(*unary)->operand);
    if (!operand || (*unary)->symbol != "-") return std::nullopt;
    return -*operand;
  }
  if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&expression.node)) {
    auto const a = constant_exponent(*(*binary)->left), b = constant_exponent(*(*binary)->right);
    if (!a || !b) return std::nullopt;
    std::string const& symbol = (*binary)->symbol;
    if (symbol == "+") return *a + *b;
    if (symbol == "-") return *a - *b;
    if (symbol == "*") return *a * *b;
    if (symbol == "/") return *a / *b;
  }
  return std::nullopt;
}

// Words that are no units, and the expression as it should be written.
struct Repair {
  std::vector<std::pair<ast::Name, std::optional<UnitSlip>>> slips;
  bool complete = true;
};
void repair(ast::UnitExpression& expression, Repair& found) {
  for (ast::UnitFactor& factor : expression.factors) {
    if (auto* inner = std::get_if<ast::Box<ast::UnitExpression>>(&factor.base)) {
      repair(**inner, found);
      continue;
    }
    ast::Name& name = std::get<ast::Name>(factor.base);
    if (unit_atom(name.text)) continue;
    std::optional<UnitSlip> slip = unit_slip(name.text);
    found.slips.emplace_back(name, slip);
    found.complete = found.complete && slip;
    if (!slip) continue;
    // [kg/ms2] is no quotient of two.
    if (factor.reciprocal && slip->meant == "m/s^2") slip->meant = "m s^2";
    bool const product = slip->meant.find(' ') != std::string::npos, quotient = slip->meant.find('/') != std::string::npos;
    bool const whole = (factor.reciprocal && (product || quotient)) || (factor.exponent && quotient);  // [Nm^2] is N m^2
    name.text = whole ? "(" + slip->meant + ")" : slip->meant;
  }
}

// One message where the whole can be repaired, else one for each word.
void report_unknown(ast::UnitExpression const& expression, Diagnostics& diagnostics) {
  ast::UnitExpression repaired = expression;
  Repair found;
  repair(repaired, found);
  for (auto const& [name, slip] : found.slips) {
    diagnostics.add(errors::unknown_unit(name, slip, "[" + (found.complete ? unparse(repaired) : slip ? slip->meant : "") + "]"));
    if (found.complete) return;
  }
}

std::optional<Unit> product(ast::UnitExpression const& expression, Diagnostics& diagnostics) {
  Unit result;
  bool good = true;
  bool const alone = expression.factors.size() == 1;
  for (ast::UnitFactor const& factor : expression.factors) {
    std::optional<Unit> base;
    if (auto const* name = std::get_if<ast::Name>(&factor.base)) {
      base = unit_atom(name->text);
    } else {
      base = product(*std::get<ast::Box<ast::UnitExpression>>(factor.base), diagnostics);
    }
    if (!base) {
      good = false;
      continue;
    }
    if (factor.exponent) {
      auto const exponent = constant_exponent(**factor.exponent);
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

}  // namespace

std::optional<Unit> check_unit(ast::UnitExpression const& expression, Diagnostics& diagnostics) {
  std::optional<Unit> unit = product(expression, diagnostics);
  if (!unit) report_unknown(expression, diagnostics);
  if (unit) unit->text = unparse(expression);
  if (unit && unit->text.size() > 1 && unit->text.front() == '[') unit->text = unit->text.substr(1, unit->text.size() - 2);
  return unit;
}

std::optional<Unit> check_unit(std::optional<ast::UnitExpression> const& expression, Diagnostics& diagnostics) {
  return expression ? check_unit(*expression, diagnostics) : std::nullopt;
}

std::optional<Diagnostic> refuse_number(Span span, errors::Subject const& what, Unit const& given, Unit const& wanted) {
  if (given.dimension != wanted.dimension || zero_against_difference(given, wanted))
    return errors::number_of_other_kind(span, what, given, wanted);
  if (cycles_against_radians(given, wanted)) return errors::number_in_cycles(span, what, given, wanted);
  return std::nullopt;
}

bool is_usual_in_degrees(double number) {
  constexpr double usual[] = {45, 90, 180, 270, 360};
  return std::ranges::find(usual, number) != std::end(usual);
}

void check_time_unit(std::optional<Unit> const& unit, Span span, Diagnostics& diagnostics) {
  if (unit && unit->dimension != unit_atom("s").value().dimension) diagnostics.add(errors::not_a_time(span, *unit));
}

}  // namespace sysid
