// Every expression inside an expression, itself first.
#pragma once
#include <type_traits>
#include <variant>

#include "syntax/ast.hpp"

namespace sysid {

/// Expression: ast::Expression, const or not; what `visit` puts in its place is walked through.
template <class Expression, class Visit>
void each_expression(Expression& tree, Visit const& visit) {
  visit(tree);
  std::visit(
      [&](auto& node) {
        using Node = std::decay_t<decltype(node)>;
        if constexpr (std::is_same_v<Node, ast::Reference>) {
          for (auto& index : node.index) each_expression(index, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Unary>>) {
          each_expression(*node->operand, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Binary>>) {
          each_expression(*node->left, visit);
          each_expression(*node->right, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Call>>) {
          for (auto& argument : node->arguments) each_expression(argument.value, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Conditional>>) {
          each_expression(*node->condition, visit);
          each_expression(*node->then, visit);
          each_expression(*node->otherwise, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::List>>) {
          for (auto& item : node->items) each_expression(item, visit);
        }
      },
      tree.node);
}

/// The names in an expression, with their primes.
template <class Visit>
void each_reference(ast::Expression const& tree, Visit const& visit) {
  each_expression(tree, [&](ast::Expression const& part) {
    if (auto const* reference = std::get_if<ast::Reference>(&part.node)) visit(*reference);
  });
}

}  // namespace sysid
