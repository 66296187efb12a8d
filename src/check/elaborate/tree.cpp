// Walks over expressions and statements.
#include "check/elaborate/tree.hpp"

namespace sysid::tree {

void each(ast::Expression const& expression, std::function<void(ast::Expression const&)> const& visit) {
  visit(expression);
  std::visit(
      [&](auto const& node) {
        using Node = std::decay_t<decltype(node)>;
        if constexpr (std::is_same_v<Node, ast::Reference>) {
          for (ast::Expression const& index : node.index) each(index, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Unary>>) {
          each(*node->operand, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Binary>>) {
          each(*node->left, visit);
          each(*node->right, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Call>>) {
          for (ast::Argument const& argument : node->arguments) each(argument.value, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Conditional>>) {
          each(*node->condition, visit);
          each(*node->then, visit);
          each(*node->otherwise, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::List>>) {
          for (ast::Expression const& item : node->items) each(item, visit);
        }
      },
      expression.node);
}

void each_top(ast::ModelStatement const& statement, std::function<void(ast::Expression const&)> const& visit) {
  auto const call = [&](ast::Call const& call) {
    for (ast::Argument const& argument : call.arguments) visit(argument.value);
  };
  std::visit(
      [&](auto const& one) {
        using One = std::decay_t<decltype(one)>;
        if constexpr (std::is_same_v<One, ast::InitialDeclaration>) {
          for (ast::InitialValue const& initial : one.values) {
            if (initial.value) visit(*initial.value);
            if (initial.law) call(*initial.law);
          }
        } else if constexpr (std::is_same_v<One, ast::DisturbanceDeclaration>) {
          call(one.law);
        } else if constexpr (std::is_same_v<One, ast::ParameterDeclaration>) {
          if (one.prior) call(*one.prior);
          if (one.value) visit(*one.value);
        } else if constexpr (std::is_same_v<One, ast::Definition> || std::is_same_v<One, ast::FunctionDefinition>) {
          visit(one.value);
        } else if constexpr (std::is_same_v<One, ast::Observation>) {
          call(one.noise);
        } else if constexpr (std::is_same_v<One, ast::ProcessDefinition>) {
          call(one.process);
        } else if constexpr (std::is_same_v<One, ast::Part>) {
          call(one.model);
        } else if constexpr (std::is_same_v<One, ast::Equation>) {
          visit(one.left);
          visit(one.right);
        }
      },
      statement);
}

void each_reference(ast::ModelStatement const& statement, std::function<void(ast::Reference const&)> const& visit) {
  each_top(statement, [&](ast::Expression const& top) {
    each(top, [&](ast::Expression const& expression) {
      if (auto const* reference = std::get_if<ast::Reference>(&expression.node)) visit(*reference);
    });
  });
}

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
