// From the leaves up, so that a product with a zero somewhere inside is zero as a whole.
#include "syntax/inserted.hpp"

#include <optional>
#include <utility>

namespace sysid {
namespace {

bool is(ast::Expression const& expression, double value) {
  auto const* number = std::get_if<ast::Number>(&expression.node);
  return number != nullptr && number->value == value && (value == 0 || !number->unit);
}

ast::Expression without_idle(ast::Expression expression);

/// What a sum, product, quotient or power with an idle side is, or a sum of numbers; nothing where it is neither.
std::optional<ast::Expression> other_side(std::string const& symbol, ast::Expression const& left, ast::Expression const& right) {
  auto const *first = std::get_if<ast::Number>(&left.node), *second = std::get_if<ast::Number>(&right.node);
  if (first != nullptr && second != nullptr && !first->unit && !second->unit && (symbol == "+" || symbol == "-"))
    return ast::Expression{{}, ast::Number{{}, symbol == "+" ? first->value + second->value : first->value - second->value, {}}};
  if (symbol == "+") {
    if (is(left, 0)) return right;
    if (is(right, 0)) return left;
  }
  if (symbol == "-" && is(right, 0)) return left;
  if (symbol == "-" && is(left, 0)) return ast::Expression{{}, ast::Box<ast::Unary>(ast::Unary{{}, "-", right})};
  if (symbol == "*") {
    if (is(left, 0) || is(right, 1)) return left;
    if (is(right, 0) || is(left, 1)) return right;
  }
  if (symbol == "/" && (is(left, 0) || is(right, 1))) return left;
  if (symbol == "^" && is(right, 1)) return left;
  return std::nullopt;
}

void clean(ast::Expression& expression) { expression = without_idle(std::move(expression)); }

ast::Expression without_idle(ast::Expression expression) {
  if (auto* unary = std::get_if<ast::Box<ast::Unary>>(&expression.node)) {
    clean(*(*unary)->operand);
    if ((*unary)->symbol == "-" && is(*(*unary)->operand, 0)) return ast::Expression(*(*unary)->operand);
  } else if (auto* binary = std::get_if<ast::Box<ast::Binary>>(&expression.node)) {
    clean(*(*binary)->left);
    clean(*(*binary)->right);
    if (auto side = other_side((*binary)->symbol, *(*binary)->left, *(*binary)->right)) return *std::move(side);
  } else if (auto* call = std::get_if<ast::Box<ast::Call>>(&expression.node)) {
    for (ast::Argument& each : (*call)->arguments) clean(each.value);
  } else if (auto* conditional = std::get_if<ast::Box<ast::Conditional>>(&expression.node)) {
    clean(*(*conditional)->condition);
    clean(*(*conditional)->then);
    clean(*(*conditional)->otherwise);
  } else if (auto* list = std::get_if<ast::Box<ast::List>>(&expression.node)) {
    for (ast::Expression& each : (*list)->items) clean(each);
  }
  return expression;
}

}  // namespace

ast::ModelStatement without_idle_terms(ast::ModelStatement statement) {
  if (auto* equation = std::get_if<ast::Equation>(&statement)) {
    clean(equation->left);
    clean(equation->right);
  } else if (auto* definition = std::get_if<ast::Definition>(&statement)) {
    clean(definition->value);
  } else if (auto* observation = std::get_if<ast::Observation>(&statement)) {
    for (ast::Argument& each : observation->noise.arguments) clean(each.value);
  }
  return statement;
}

}  // namespace sysid
