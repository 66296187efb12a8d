// Counts without a walk to the end: an expression may be larger than what is left to spend.
#include "check/elaborate/tree.hpp"

namespace sysid::tree {

std::size_t size(ast::Expression const& expression, std::size_t most) {
  std::size_t count = 1;
  auto const add = [&](ast::Expression const& below) {
    if (count < most) count += size(below, most - count);
  };
  std::visit(
      [&](auto const& node) {
        using Node = std::decay_t<decltype(node)>;
        if constexpr (std::is_same_v<Node, ast::Box<ast::Unary>>) {
          add(*node->operand);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Binary>>) {
          add(*node->left);
          add(*node->right);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Call>>) {
          for (ast::Argument const& argument : node->arguments) add(argument.value);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Conditional>>) {
          add(*node->condition);
          add(*node->then);
          add(*node->otherwise);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::List>>) {
          for (ast::Expression const& item : node->items) add(item);
        }
      },
      expression.node);
  return count;
}

}  // namespace sysid::tree
