// Every expression inside an expression or a statement, the outer one first.
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

/// The expressions of a statement of a model, not those inside them. Statement: ast::ModelStatement or one of its kinds, const or
/// not.
template <class Statement, class Visit>
void each_top_expression(Statement& statement, Visit const& visit) {
  using One = std::remove_const_t<Statement>;
  auto const arguments = [&](auto& call) {
    for (auto& argument : call.arguments) visit(argument.value);
  };
  if constexpr (std::is_same_v<One, ast::ModelStatement>) {
    std::visit([&](auto& one) { each_top_expression(one, visit); }, statement);
  } else if constexpr (std::is_same_v<One, ast::InitialDeclaration>) {
    for (auto& initial : statement.values) {
      if (initial.value) visit(*initial.value);
      if (initial.law) arguments(*initial.law);
    }
  } else if constexpr (std::is_same_v<One, ast::DisturbanceDeclaration>) {
    arguments(statement.law);
  } else if constexpr (std::is_same_v<One, ast::ParameterDeclaration>) {
    if (statement.prior) arguments(*statement.prior);
    if (statement.value) visit(*statement.value);
  } else if constexpr (std::is_same_v<One, ast::Definition> || std::is_same_v<One, ast::FunctionDefinition>) {
    visit(statement.value);
  } else if constexpr (std::is_same_v<One, ast::Observation>) {
    arguments(statement.noise);
  } else if constexpr (std::is_same_v<One, ast::ProcessDefinition>) {
    arguments(statement.process);
  } else if constexpr (std::is_same_v<One, ast::Part>) {
    arguments(statement.model);
  } else if constexpr (std::is_same_v<One, ast::Equation>) {
    visit(statement.left);
    visit(statement.right);
  }
}

/// The names in an expression, with their primes.
template <class Visit>
void each_reference(ast::Expression const& tree, Visit const& visit) {
  each_expression(tree, [&](ast::Expression const& part) {
    if (auto const* reference = std::get_if<ast::Reference>(&part.node)) visit(*reference);
  });
}

/// The names on both sides of an equation.
template <class Visit>
void each_reference(ast::Equation const& equation, Visit const& visit) {
  each_reference(equation.left, visit);
  each_reference(equation.right, visit);
}

/// The names that a statement of a model reads.
template <class Visit>
void each_reference(ast::ModelStatement const& statement, Visit const& visit) {
  each_top_expression(statement, [&](ast::Expression const& top) { each_reference(top, visit); });
}

}  // namespace sysid
