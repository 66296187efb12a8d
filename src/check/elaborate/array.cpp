// Shapes, and the rules by which vectors and matrices are added, multiplied and filled.
#include "check/elaborate/array.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "check/elaborate/tree.hpp"
#include "check/message/errors_reuse.hpp"

namespace sysid {
namespace {

// One element, however it is written.
bool is_single(Shape const& shape) { return shape.count() == 1; }

// Whether this array may stand for every element of another shape.
bool spreads(Array const& array, bool any_number) {
  return is_single(array.shape) && (any_number || tree::is_plain_number(array.items.front()));
}

// From left to right; the halves of a long sum each for itself, so that the tree is not as deep as the sum is long.
ast::Expression sum_of(std::span<ast::Expression const> terms, Span span) {
  constexpr std::size_t longest = 200;
  if (terms.size() > longest) {
    std::size_t const half = terms.size() / 2;
    return tree::sum(sum_of(terms.first(half), span), sum_of(terms.subspan(half), span), span);
  }
  ast::Expression total = tree::number(0, span);
  for (ast::Expression const& term : terms) total = tree::sum(std::move(total), term, span);
  return total;
}

}  // namespace

std::string element_name(std::string const& name, Shape const& shape, std::size_t element) {
  if (shape.rank == 0) return name;
  auto const columns = static_cast<std::size_t>(shape.columns);
  if (shape.rank == 1) return fmt::format("{}[{}]", name, element + 1);
  return fmt::format("{}[{}, {}]", name, element / columns + 1, element % columns + 1);
}

Array scalar(ast::Expression expression) {
  Array array;
  array.items.push_back(std::move(expression));
  return array;
}

ast::Expression as_expression(Array array, Span span) {
  if (array.shape.rank == 0) return std::move(array.items.front());
  if (array.shape.rank == 1) return {{span}, ast::Box<ast::List>(ast::List{{span}, std::move(array.items)})};
  ast::List rows{{span}, {}};
  for (int i = 0; i < array.shape.rows; ++i) {
    ast::List row{{span}, {}};
    for (int j = 0; j < array.shape.columns; ++j) row.items.push_back(array.at(i, j));
    rows.items.push_back({{span}, ast::Box<ast::List>(std::move(row))});
  }
  return {{span}, ast::Box<ast::List>(std::move(rows))};
}

bool ArrayAlgebra::spend(std::size_t nodes, Span span) {
  if (nodes <= left_) {
    left_ -= nodes;
    return true;
  }
  refuse(span);
  return false;
}
void ArrayAlgebra::refuse(Span span) {
  left_ = 0;
  if (!said_) diagnostics_.add(errors::model_too_large(span));
  said_ = true;
}
bool ArrayAlgebra::spend(Array const& array, Span span) {
  std::size_t nodes = 0;
  for (ast::Expression const& item : array.items)
    if (nodes <= left_) nodes += tree::size(item, left_ + 1 - nodes);
  return spend(nodes, span);
}

std::optional<Array> ArrayAlgebra::fill(Array array, Shape const& shape, bool any_number, errors::Subject const& what, Span span) {
  if (array.shape == shape) return array;
  if (is_single(array.shape) && is_single(shape)) {
    array.shape = shape;
    return array;
  }
  // A list of one row where a matrix of one column is meant, or the reverse, is a conflict: nothing is guessed.
  if (!spreads(array, any_number)) {
    diagnostics_.add(errors::wrong_shape(span, what, array.shape, shape));
    return std::nullopt;
  }
  Array filled{shape, {}};
  if (!spend(shape.count() * tree::size(array.items.front(), left_), span)) return std::nullopt;
  filled.items.assign(shape.count(), array.items.front());
  return filled;
}

std::optional<Array> ArrayAlgebra::unary(std::string const& symbol, Array operand, Span span) {
  for (ast::Expression& item : operand.items)
    if (!tree::is_number(item, 0) || symbol != "-" || operand.shape.rank == 0) item = tree::unary(symbol, std::move(item), span);
  return operand;
}

std::optional<Array> ArrayAlgebra::binary(std::string const& symbol, Array left, Array right, Span span) {
  if (left.shape.rank == 0 && right.shape.rank == 0)
    return scalar(tree::binary(symbol, std::move(left.items.front()), std::move(right.items.front()), span));
  if (symbol == "*" && !is_single(left.shape) && !is_single(right.shape)) return product(left, right, span);
  bool const scales = symbol == "*" || (symbol == "/" && is_single(right.shape));
  bool const raises = symbol == "^" && is_single(right.shape) && left.shape.rank < 2;
  bool const compares = symbol == "<" || symbol == "<=" || symbol == ">" || symbol == ">=" || symbol == "==" || symbol == "!=" ||
                        symbol == "and" || symbol == "or";
  bool const adds = symbol == "+" || symbol == "-";
  Shape const shape = left.shape.count() > right.shape.count()   ? left.shape
                      : left.shape.count() < right.shape.count() ? right.shape
                      : left.shape.rank >= right.shape.rank      ? left.shape
                                                                 : right.shape;
  auto const fits = [&](Array const& array) {
    return array.shape == shape || is_single(shape) || spreads(array, scales || raises || compares);
  };
  if (!(scales || raises || compares || adds) || !fits(left) || !fits(right)) {
    diagnostics_.add(
        errors::shape_conflict(span, symbol, left.shape, left.items.front().span, right.shape, right.items.front().span));
    return std::nullopt;
  }
  auto const a = fill(std::move(left), shape, true, {}, span), b = fill(std::move(right), shape, true, {}, span);
  if (!a || !b) return std::nullopt;
  Array result{shape, {}};
  for (std::size_t i = 0; i < shape.count(); ++i) {
    if (symbol == "+")
      result.items.push_back(tree::sum(a->items[i], b->items[i], span));
    else if (symbol == "*")
      result.items.push_back(tree::product(a->items[i], b->items[i], span));
    else if (symbol == "-" && tree::is_number(b->items[i], 0))
      result.items.push_back(a->items[i]);
    else if (symbol == "-" && tree::is_number(a->items[i], 0))
      result.items.push_back(tree::unary("-", b->items[i], span));
    else
      result.items.push_back(tree::binary(symbol, a->items[i], b->items[i], span));
  }
  if (!spend(result, span)) return std::nullopt;
  return result;
}

std::optional<Array> ArrayAlgebra::product(Array const& left, Array const& right, Span span) {
  bool const fits = left.shape.rank == 2 ? left.shape.columns == right.shape.rows : right.shape.rank == 2 && right.shape.rows == 1;
  if (!fits) {
    diagnostics_.add(errors::shape_conflict(span, "*", left.shape, left.items.front().span, right.shape, right.items.front().span));
    return std::nullopt;
  }
  // A row times a column is a number, a matrix times a vector a vector.
  int const rows = left.shape.rows, inner = left.shape.columns, columns = right.shape.columns;
  Array result{right.shape.rank == 1 ? (rows == 1 ? Shape{} : vector_of(rows)) : matrix_of(rows, columns), {}};
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      std::vector<ast::Expression> terms;
      for (int k = 0; k < inner; ++k) {
        terms.push_back(tree::product(left.at(i, k), right.at(k, j), span));
        if (!spend(tree::size(terms.back(), left_ + 1), span)) return std::nullopt;
      }
      result.items.push_back(sum_of(terms, span));
    }
  return result;
}

std::optional<Array> ArrayAlgebra::transpose(Array array, Span) {
  Array result{matrix_of(array.shape.columns, array.shape.rows), {}};
  for (int j = 0; j < array.shape.columns; ++j)
    for (int i = 0; i < array.shape.rows; ++i) result.items.push_back(array.at(i, j));
  return result;
}

std::optional<Array> ArrayAlgebra::sum(Array const& array, Span span) {
  if (!spend(array, span)) return std::nullopt;
  return scalar(sum_of(array.items, span));
}

std::optional<Array> ArrayAlgebra::dot(Array const& left, Array const& right, Span span) {
  if (left.shape.rank == 2 || right.shape.rank == 2 || left.shape.count() != right.shape.count()) {
    diagnostics_.add(
        errors::shape_conflict(span, "dot", left.shape, left.items.front().span, right.shape, right.items.front().span));
    return std::nullopt;
  }
  Array terms{left.shape, {}};
  for (std::size_t i = 0; i < left.items.size(); ++i) terms.items.push_back(tree::product(left.items[i], right.items[i], span));
  return sum(terms, span);
}

std::optional<Array> ArrayAlgebra::each_element(ast::Name const& function, std::vector<Array> arguments, Span span) {
  Shape shape;
  for (Array const& argument : arguments)
    if (argument.shape.count() > shape.count() || (argument.shape.count() == shape.count() && argument.shape.rank > shape.rank))
      shape = argument.shape;
  for (Array& argument : arguments) {
    auto filled = fill(std::move(argument), shape, true, errors::named("an argument of", function.text), span);
    if (!filled) return std::nullopt;
    argument = std::move(*filled);
  }
  Array result{shape, {}};
  for (std::size_t i = 0; i < shape.count(); ++i) {
    std::vector<ast::Expression> values;
    for (Array& argument : arguments) values.push_back(std::move(argument.items[i]));
    result.items.push_back(tree::call(function, std::move(values), span));
  }
  if (shape.rank > 0 && !spend(result, span)) return std::nullopt;
  return result;
}

std::optional<Array> ArrayAlgebra::conditional(Array condition, Array then, Array otherwise, Span span) {
  Shape shape;
  for (Array const* array : {&condition, &then, &otherwise})
    if (array->shape.count() > shape.count() || array->shape.rank > shape.rank) shape = array->shape;
  auto a = fill(std::move(condition), shape, true, {"the condition"}, span);
  auto b = fill(std::move(then), shape, true, {"the first branch"}, span);
  auto c = fill(std::move(otherwise), shape, true, {"the other branch"}, span);
  if (!a || !b || !c) return std::nullopt;
  Array result{shape, {}};
  for (std::size_t i = 0; i < shape.count(); ++i)
    result.items.push_back({{span},
                            ast::Box<ast::Conditional>(
                                ast::Conditional{{span}, std::move(a->items[i]), std::move(b->items[i]), std::move(c->items[i])})});
  return result;
}

std::optional<Array> ArrayAlgebra::list(std::vector<Array> items, Span span) {
  Array result{vector_of(static_cast<int>(items.size())), {}};
  Shape const first = items.front().shape;
  if (first.rank == 1) result.shape = matrix_of(static_cast<int>(items.size()), first.rows);
  for (Array& item : items) {
    if (item.shape != first || first.rank > 1) {
      diagnostics_.add(errors::uneven_list(span, first, item.shape, item.items.front().span));
      return std::nullopt;
    }
    for (ast::Expression& each : item.items) result.items.push_back(std::move(each));
  }
  return result;
}

}  // namespace sysid
