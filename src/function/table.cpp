// The functions of the language: one row each. A primitive is called, the others are built from operations. A new one is declared
// above the table and has a row in it (docs/extending.md).
#include "function/table.hpp"

#include <limits>
#include <numbers>

#include "core/setting/table.hpp"
#include "function/primitive.hpp"

namespace sysid {
namespace {

using Arguments = std::span<NodeId const>;

template <Function const& function>
NodeId primitive(Graph& graph, Arguments a) {
  return function.arity == 1 ? graph.call(function, a[0]) : graph.call(function, a[0], a[1]);
}

template <Operation operation>
NodeId unary(Graph& graph, Arguments a) {
  return graph.unary(operation, a[0]);
}

/// min(a, b, c) = min(min(a, b), c).
template <Operation operation>
NodeId chain(Graph& graph, Arguments a) {
  NodeId result = a[0];
  for (NodeId const argument : a.subspan(1)) result = graph.binary(operation, result, argument);
  return result;
}

/// sqrt(x^2 + y^2); overflows where a square does, at 1e154.
NodeId hypot(Graph& graph, Arguments a) {
  Term const x(graph, a[0]), y(graph, a[1]);
  Term const square = y * y;
  return sqrt(x * x + square).id;
}

/// Heaviside's step with step(0) = 1.
NodeId step(Graph& graph, Arguments a) { return less_equal(Term(graph, 0.0), Term(graph, a[0])).id; }

NodeId clamp(Graph& graph, Arguments a) { return min(max(Term(graph, a[0]), Term(graph, a[1])), Term(graph, a[2])).id; }

/// The value behind the first condition that holds, else the last argument.
NodeId piecewise(Graph& graph, Arguments a) {
  NodeId result = a.back();
  for (std::size_t i = a.size() - 1; i >= 2; i -= 2) result = graph.select(a[i - 2], a[i - 1], result);
  return result;
}

/// Phi(x) = erfc(-x / sqrt 2) / 2, accurate in the lower tail. DLMF 7.18
NodeId normal_cdf(Graph& graph, Arguments a) { return (0.5 * erfc(-(Term(graph, a[0]) / std::numbers::sqrt2))).id; }

constexpr int any = std::numeric_limits<int>::max();
using enum UnitRule;

constexpr FunctionRow rows[] = {
    {"exp", 1, 1, dimensionless, &primitive<exp_function>, "e^x"},
    {"expm1", 1, 1, dimensionless, &primitive<expm1_function>, "e^x - 1, accurate near 0"},
    {"log", 1, 1, dimensionless, &primitive<log_function>, "natural logarithm"},
    {"log1p", 1, 1, dimensionless, &primitive<log1p_function>, "log(1 + x), accurate near 0"},
    {"log10", 1, 1, dimensionless, &primitive<log10_function>, "decimal logarithm"},
    {"sqrt", 1, 1, root, &unary<Operation::square_root>, "square root"},
    {"hypot", 2, 2, same, &hypot, "sqrt(x^2 + y^2)"},
    {"abs", 1, 1, same, &unary<Operation::absolute>, "absolute value"},
    {"sign", 1, 1, none, &unary<Operation::sign>, "-1, 0 or 1"},
    {"min", 2, any, same, &chain<Operation::minimum>, "smallest of two or more"},
    {"max", 2, any, same, &chain<Operation::maximum>, "largest of two or more"},
    {"clamp", 3, 3, same, &clamp, "clamp(x, low, high): x limited to the range from low to high"},
    {"piecewise", 3, any, branches, &piecewise, "piecewise(a < b, x, c < d, y, z): x where a < b, else y where c < d, else z"},
    {"step", 1, 1, none, &step, "1 where x >= 0, else 0"},
    {"floor", 1, 1, dimensionless, &unary<Operation::floor>, "largest integer not above x"},
    {"sin", 1, 1, angle, &primitive<sin_function>, "sine of an angle in radians"},
    {"cos", 1, 1, angle, &primitive<cos_function>, "cosine of an angle in radians"},
    {"tan", 1, 1, angle, &primitive<tan_function>, "tangent of an angle in radians"},
    {"asin", 1, 1, dimensionless, &primitive<asin_function>, "inverse sine, radians"},
    {"acos", 1, 1, dimensionless, &primitive<acos_function>, "inverse cosine, radians"},
    {"atan", 1, 1, dimensionless, &primitive<atan_function>, "inverse tangent, radians"},
    {"atan2", 2, 2, ratio, &primitive<atan2_function>, "atan2(y, x): angle of the point (x, y), radians"},
    {"sinh", 1, 1, dimensionless, &primitive<sinh_function>, "hyperbolic sine"},
    {"cosh", 1, 1, dimensionless, &primitive<cosh_function>, "hyperbolic cosine"},
    {"tanh", 1, 1, dimensionless, &primitive<tanh_function>, "hyperbolic tangent"},
    {"erf", 1, 1, dimensionless, &primitive<erf_function>, "error function"},
    {"erfc", 1, 1, dimensionless, &primitive<erfc_function>, "1 - erf(x), accurate for large x"},
    {"lgamma", 1, 1, dimensionless, &primitive<lgamma_function>, "logarithm of |Gamma(x)|"},
    {"normal_cdf", 1, 1, dimensionless, &normal_cdf, "standard normal distribution function"},
};

}  // namespace

std::span<FunctionRow const> functions() { return rows; }

FunctionRow const* find_function(std::string_view name) { return row_named(rows, name); }

}  // namespace sysid
