// The table of functions of vectors and matrices.
#include "check/elaborate/array_functions.hpp"

#include <algorithm>

#include "check/elaborate/tree.hpp"

namespace sysid {
namespace {

using Arrays = std::vector<Array>;
using Sizes = std::vector<long>;

constexpr long most_rows = 100;

ast::Name named(char const* text, Span span) { return {{span}, text}; }
bool is_vector(Array const& array) { return array.shape.rank < 2; }

Array filled(Shape shape, double value, Span span) {
  Array array{shape, {}};
  array.items.assign(shape.count(), tree::number(value, span));
  return array;
}
bool in_range(Sizes const& sizes) {
  return std::all_of(sizes.begin(), sizes.end(), [](long size) { return size >= 1 && size <= most_rows; });
}
ast::Expression& at(Array& array, long row, long column) {
  return array.items[static_cast<std::size_t>(row * array.shape.columns + column)];
}

std::optional<Array> sum(ArrayAlgebra& algebra, Arrays& arguments, Sizes const&, Span span) {
  return arguments.size() == 1 ? algebra.sum(arguments[0], span) : std::nullopt;
}
std::optional<Array> dot(ArrayAlgebra& algebra, Arrays& arguments, Sizes const&, Span span) {
  return arguments.size() == 2 ? algebra.dot(arguments[0], arguments[1], span) : std::nullopt;
}
std::optional<Array> norm(ArrayAlgebra& algebra, Arrays& arguments, Sizes const&, Span span) {
  if (arguments.size() != 1) return std::nullopt;
  Array squares{arguments[0].shape, {}};
  for (ast::Expression& item : arguments[0].items)
    squares.items.push_back(tree::binary("^", std::move(item), tree::number(2, span), span));
  auto total = algebra.sum(squares, span);
  if (!total) return std::nullopt;
  return scalar(tree::call(named("sqrt", span), {std::move(total->items.front())}, span));
}
std::optional<Array> transpose(ArrayAlgebra& algebra, Arrays& arguments, Sizes const&, Span span) {
  return arguments.size() == 1 ? algebra.transpose(std::move(arguments[0]), span) : std::nullopt;
}
std::optional<Array> diagonal(ArrayAlgebra& algebra, Arrays& arguments, Sizes const&, Span span) {
  Array entries{{}, {}};
  for (Array& argument : arguments) {
    if (!is_vector(argument) || (arguments.size() > 1 && argument.shape.count() != 1)) return std::nullopt;
    for (ast::Expression& item : argument.items) entries.items.push_back(std::move(item));
  }
  if (entries.items.empty()) return std::nullopt;
  int const n = static_cast<int>(entries.items.size());
  if (!algebra.spend(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), span)) return std::nullopt;
  Array result = filled(matrix_of(n, n), 0, span);
  for (int i = 0; i < n; ++i) at(result, i, i) = std::move(entries.items[static_cast<std::size_t>(i)]);
  return result;
}
// Below, on and above the diagonal; the diagonal, or any vector, tells the size.
std::optional<Array> tridiagonal(ArrayAlgebra& algebra, Arrays& arguments, Sizes const&, Span span) {
  if (arguments.size() != 3 || !is_vector(arguments[0]) || !is_vector(arguments[1]) || !is_vector(arguments[2]))
    return std::nullopt;
  int const n = arguments[1].shape.rows;
  for (std::size_t const side : {std::size_t{0}, std::size_t{2}})
    if (arguments[side].shape.rank == 1 && arguments[side].shape.rows != n - 1) return std::nullopt;
  Array result = filled(matrix_of(n, n), 0, span);
  auto const item = [&](std::size_t which, int i) {
    return arguments[which].items[arguments[which].shape.rank == 0 ? 0 : static_cast<std::size_t>(i)];
  };
  for (int i = 0; i < n; ++i) {
    at(result, i, i) = item(1, i);
    if (i + 1 == n) continue;
    at(result, i + 1, i) = item(0, i);
    at(result, i, i + 1) = item(2, i);
  }
  if (!algebra.spend(result, span)) return std::nullopt;
  return result;
}
std::optional<Array> identity(ArrayAlgebra&, Arrays&, Sizes const& sizes, Span span) {
  if (sizes.size() != 1 || !in_range(sizes)) return std::nullopt;
  Array result = filled(matrix_of(static_cast<int>(sizes[0]), static_cast<int>(sizes[0])), 0, span);
  for (long i = 0; i < sizes[0]; ++i) at(result, i, i) = tree::number(1, span);
  return result;
}
std::optional<Array> differences(ArrayAlgebra& algebra, Arrays& arguments, Sizes const& sizes, Span span) {
  auto result = identity(algebra, arguments, sizes, span);
  if (result)
    for (long i = 1; i < sizes[0]; ++i) at(*result, i, i - 1) = tree::number(-1, span);
  return result;
}
std::optional<Array> constant_array(Sizes const& sizes, double value, Span span) {
  if (sizes.empty() || sizes.size() > 2 || !in_range(sizes)) return std::nullopt;
  int const rows = static_cast<int>(sizes[0]);
  return filled(sizes.size() == 1 ? vector_of(rows) : matrix_of(rows, static_cast<int>(sizes[1])), value, span);
}
std::optional<Array> zeros(ArrayAlgebra&, Arrays&, Sizes const& sizes, Span span) { return constant_array(sizes, 0, span); }
std::optional<Array> ones(ArrayAlgebra&, Arrays&, Sizes const& sizes, Span span) { return constant_array(sizes, 1, span); }
std::optional<Array> integers(ArrayAlgebra&, Arrays&, Sizes const& sizes, Span span) {
  if (sizes.size() != 1 || !in_range(sizes)) return std::nullopt;
  Array result = filled(vector_of(static_cast<int>(sizes[0])), 0, span);
  for (long i = 0; i < sizes[0]; ++i) at(result, i, 0) = tree::number(static_cast<double>(i + 1), span);
  return result;
}
std::optional<Array> unit_vector(ArrayAlgebra&, Arrays&, Sizes const& sizes, Span span) {
  if (sizes.size() != 2 || !in_range(sizes) || sizes[1] > sizes[0]) return std::nullopt;
  Array result = filled(vector_of(static_cast<int>(sizes[0])), 0, span);
  result.items[static_cast<std::size_t>(sizes[1] - 1)] = tree::number(1, span);
  return result;
}

constexpr ArrayFunctionRow rows[] = {
    {"sum", "sum(v)", "sum of all elements", &sum},
    {"dot", "dot(a, b)", "sum of products of two vectors", &dot},
    {"norm", "norm(v)", "square root of the sum of squares", &norm},
    {"transpose", "transpose(A)", "rows to columns; a vector becomes a row", &transpose},
    {"diagonal", "diagonal(v) or diagonal(a, b, c)", "matrix with these on its diagonal", &diagonal},
    {"tridiagonal", "tridiagonal(below, on, above)", "matrix with these on its three diagonals; `on` is a vector", &tridiagonal},
    {"identity", "identity(n)", "identity matrix, n up to 100", &identity, true},
    {"differences", "differences(n)", "matrix D: (D*q)[1] = q[1], (D*q)[i] = q[i] - q[i-1]; n up to 100", &differences, true},
    {"zeros", "zeros(n) or zeros(n, m)", "vector or matrix of zeros", &zeros, true},
    {"ones", "ones(n) or ones(n, m)", "vector or matrix of ones", &ones, true},
    {"integers", "integers(n)", "vector 1, 2, ..., n", &integers, true},
    {"unit_vector", "unit_vector(n, i)", "vector with n elements: 1 at position i, 0 elsewhere", &unit_vector, true},
};

}  // namespace

std::span<ArrayFunctionRow const> array_functions() { return rows; }

ArrayFunctionRow const* find_array_function(std::string_view name) {
  auto const row = std::find_if(std::begin(rows), std::end(rows), [&](ArrayFunctionRow const& each) { return each.name == name; });
  return row == std::end(rows) ? nullptr : row;
}

}  // namespace sysid
