// Numbers, vectors and matrices of expressions: what a quantity of the user's is made of before the checker sees numbers only.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "check/message/subject.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"
#include "syntax/shape.hpp"

namespace sysid {

/// "q[2]", "M[1, 2]"; the name itself where the shape is a number. element: row by row, from 0.
std::string element_name(std::string const& name, Shape const& shape, std::size_t element);

/// Expressions in terms of numbers, row by row.
struct Array {
  Shape shape;
  std::vector<ast::Expression> items;

  ast::Expression const& at(int row, int column) const { return items[static_cast<std::size_t>(row * shape.columns + column)]; }
};
Array scalar(ast::Expression expression);
/// Nested lists for what is no number: as the user would write it.
ast::Expression as_expression(Array array, Span span);

/// Operations on arrays. Results are bounded in size: beyond it an E2708 is added, once, and every result is empty.
class ArrayAlgebra {
 public:
  ArrayAlgebra(Diagnostics& diagnostics, std::size_t most_nodes) : diagnostics_(diagnostics), left_(most_nodes) {}
  std::size_t left() const { return left_; }

  /// Nothing, with a diagnostic, when the shapes do not fit.
  std::optional<Array> unary(std::string const& symbol, Array operand, Span span);
  std::optional<Array> binary(std::string const& symbol, Array left, Array right, Span span);
  /// Element by element; numbers stand for every element.
  std::optional<Array> each_element(ast::Name const& function, std::vector<Array> arguments, Span span);
  std::optional<Array> conditional(Array condition, Array then, Array otherwise, Span span);
  std::optional<Array> list(std::vector<Array> items, Span span);

  std::optional<Array> product(Array const& left, Array const& right, Span span);
  std::optional<Array> transpose(Array array, Span span);
  std::optional<Array> sum(Array const& array, Span span);
  std::optional<Array> dot(Array const& left, Array const& right, Span span);

  /// `array` in this shape: itself, or a number that stands for every element. what: for the message.
  std::optional<Array> fill(Array array, Shape const& shape, bool any_number, errors::Subject const& what, Span span);

  /// Counts towards the bound; false when it is reached.
  bool spend(Array const& array, Span span);
  bool spend(std::size_t nodes, Span span);
  /// Reports, once, that the bound is reached; nothing is computed from then on.
  void refuse(Span span);
  bool exhausted() const { return said_; }

 private:
  Diagnostics& diagnostics_;
  std::size_t left_;
  bool said_ = false;
};

}  // namespace sysid
