// Building expressions of the syntax tree.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "syntax/ast.hpp"

namespace sysid::tree {

inline ast::Expression number(double value, Span span) { return {{span}, ast::Number{{span}, value, std::nullopt}}; }
inline ast::Expression reference(std::string name, int primes, Span span) {
  return {{span}, ast::Reference{{span}, {{span}, std::move(name)}, {}, primes}};
}
inline ast::Expression unary(std::string symbol, ast::Expression operand, Span span) {
  return {{span}, ast::Box<ast::Unary>(ast::Unary{{span}, std::move(symbol), std::move(operand)})};
}
inline ast::Expression binary(std::string symbol, ast::Expression left, ast::Expression right, Span span) {
  return {{span}, ast::Box<ast::Binary>(ast::Binary{{span}, std::move(symbol), std::move(left), std::move(right)})};
}
inline ast::Expression call(ast::Name function, std::vector<ast::Expression> values, Span span) {
  ast::Call call{{span}, std::move(function), {}};
  for (ast::Expression& value : values) {
    Span const place = value.span;
    call.arguments.push_back({{place}, std::nullopt, std::move(value)});
  }
  return {{span}, ast::Box<ast::Call>(std::move(call))};
}

/// A number without a unit, or one under a minus sign: it adapts to what it meets, so it stands for itself in every element.
inline bool is_plain_number(ast::Expression const& expression) {
  if (auto const* number = std::get_if<ast::Number>(&expression.node)) return !number->unit;
  auto const* unary = std::get_if<ast::Box<ast::Unary>>(&expression.node);
  return unary != nullptr && (*unary)->symbol == "-" && is_plain_number(*(*unary)->operand);
}
inline bool is_number(ast::Expression const& expression, double value) {
  auto const* number = std::get_if<ast::Number>(&expression.node);
  return number != nullptr && !number->unit && number->value == value;
}

/// a + b, a - b and a * b, less the terms that are 0 and the factors that are 1.
inline ast::Expression sum(ast::Expression a, ast::Expression b, Span span) {
  if (is_number(a, 0)) return b;
  if (is_number(b, 0)) return a;
  return binary("+", std::move(a), std::move(b), span);
}
inline ast::Expression difference(ast::Expression a, ast::Expression b, Span span) {
  if (is_number(b, 0)) return a;
  if (is_number(a, 0)) return unary("-", std::move(b), span);
  return binary("-", std::move(a), std::move(b), span);
}
inline ast::Expression product(ast::Expression a, ast::Expression b, Span span) {
  if (is_number(a, 0) || is_number(b, 0)) return number(0, span);
  if (is_number(a, 1)) return b;
  if (is_number(b, 1)) return a;
  return binary("*", std::move(a), std::move(b), span);
}

/// How many nodes, counted up to `most`.
std::size_t size(ast::Expression const& expression, std::size_t most);

}  // namespace sysid::tree
