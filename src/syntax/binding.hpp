// How tightly the operators of the language bind (grammar/sysid.ebnf), for all that writes expressions down.
#pragma once
#include <string_view>

#include "syntax/ast.hpp"

namespace sysid {

/// How tightly an expression holds together, loosest first; an operand looser than its place wants needs parentheses.
enum class OperatorBinding { conditional, disjunction, conjunction, negation, comparison, sum, product, sign, power, primary };

/// A binary operator, and what its operands must hold at least.
struct OperatorRow {
  std::string_view symbol;
  OperatorBinding binding, left, right;
};
OperatorRow const& operator_row(std::string_view symbol);

OperatorBinding binding(ast::Expression const& expression);

}  // namespace sysid
