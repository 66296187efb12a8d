// Arithmetic of whole numbers on the syntax tree, bounded so that nothing overflows.
#include "check/elaborate/whole_number.hpp"

#include <cmath>

#include "check/elaborate/tree.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

constexpr double largest = 1e9;

// Exponents of units may be fractions, so the arithmetic is on reals, exact for the numbers in question.
std::optional<double> value_of(ast::Expression const& expression, WholeNumbers const& known) {
  if (auto const* number = std::get_if<ast::Number>(&expression.node))
    return number->unit ? std::nullopt : std::optional(number->value);
  if (auto const* reference = std::get_if<ast::Reference>(&expression.node)) {
    auto const place = known.find(reference->name.text);
    if (place == known.end() || reference->primes > 0 || !reference->index.empty()) return std::nullopt;
    return static_cast<double>(place->second);
  }
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&expression.node)) {
    auto const operand = value_of(*(*unary)->operand, known);
    if (!operand || (*unary)->symbol != "-") return std::nullopt;
    return -*operand;
  }
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&expression.node);
  if (binary == nullptr) return std::nullopt;
  auto const a = value_of(*(*binary)->left, known), b = value_of(*(*binary)->right, known);
  if (!a || !b) return std::nullopt;
  std::string const& symbol = (*binary)->symbol;
  double const result = symbol == "+"   ? *a + *b
                        : symbol == "-" ? *a - *b
                        : symbol == "*" ? *a * *b
                        : symbol == "/" ? *a / *b
                        : symbol == "^" ? std::pow(*a, *b)
                                        : std::nan("");
  if (!(std::fabs(result) <= largest)) return std::nullopt;
  return result;
}

}  // namespace

std::optional<long> whole_number(ast::Expression const& expression, WholeNumbers const& known) {
  auto const value = value_of(expression, known);
  if (!value || *value != std::floor(*value) || std::fabs(*value) > largest) return std::nullopt;
  return static_cast<long>(*value);
}

ast::UnitExpression with_arguments(ast::UnitExpression unit, WholeNumbers const& known) {
  if (known.empty()) return unit;
  for (ast::UnitFactor& factor : unit.factors) {
    if (auto* group = std::get_if<ast::Box<ast::UnitExpression>>(&factor.base)) *group = with_arguments(std::move(**group), known);
    if (!factor.exponent) continue;
    bool reads_argument = false;
    each_expression(**factor.exponent, [&](ast::Expression const& each) {
      auto const* reference = std::get_if<ast::Reference>(&each.node);
      reads_argument = reads_argument || (reference != nullptr && known.contains(reference->name.text));
    });
    auto const value = reads_argument ? value_of(**factor.exponent, known) : std::nullopt;
    if (!value) continue;
    Span const span = (*factor.exponent)->span;
    factor.exponent = *value < 0 ? tree::unary("-", tree::number(-*value, span), span) : tree::number(*value, span);
  }
  // A factor to the power 0 says nothing: [N^(1-n)/m] is [1/m] for n = 1.
  std::erase_if(unit.factors,
                [](ast::UnitFactor const& factor) { return factor.exponent && tree::is_number(**factor.exponent, 0); });
  if (unit.factors.empty()) unit.factors.push_back({{unit.span}, ast::Name{{unit.span}, "1"}, std::nullopt, false});
  if (unit.factors.front().reciprocal)
    unit.factors.insert(unit.factors.begin(), {{unit.span}, ast::Name{{unit.span}, "1"}, std::nullopt, false});
  return unit;
}

std::optional<ast::UnitExpression> with_arguments(std::optional<ast::UnitExpression> unit, WholeNumbers const& known) {
  if (unit) unit = with_arguments(std::move(*unit), known);
  return unit;
}

}  // namespace sysid
