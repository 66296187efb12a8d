// Expressions of the language as formulas, in any notation.
#pragma once
#include <string>
#include <vector>

#include "syntax/ast.hpp"
#include "typeset/notation.hpp"
#include "typeset/symbol.hpp"

namespace sysid {

/// Writes expressions down as print shows them: fractions, roots, bars, powers, dots for derivatives by time; only the parentheses
/// that a reader of the page needs.
class Formula {
 public:
  /// symbols: of the model that the expressions are of.
  Formula(Notation const& notation, Symbols& symbols) : to_(notation), symbols_(symbols) {}

  std::string operator()(ast::Expression const& expression) const;
  std::string operator()(ast::Reference const& reference) const;
  /// A name alone.
  std::string name(std::string_view name) const;
  /// f(a, b), or what print has in its place: a root, bars, e of a normal distribution.
  std::string call(ast::Call const& call) const;
  /// N(y, sigma^2), LogUniform(0.1, 10): a distribution as printed.
  std::string distribution(ast::Call const& call) const;
  std::string unit(ast::UnitExpression const& unit) const;
  /// left SIGN right.
  std::string joined(std::string const& left, Sign sign, std::string const& right) const;

 private:
  class Visitor;
  std::string number(double value) const;
  std::string arguments(std::vector<ast::Argument> const& arguments) const;
  std::string list(std::vector<std::string> const& pieces) const;

  Notation const& to_;
  Symbols& symbols_;
};

}  // namespace sysid
