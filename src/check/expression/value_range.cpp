// Interval arithmetic from the leaves up. Rounding is ignored, since only signs are needed.
#include "check/expression/value_range.hpp"

#include "core/numeric/not_finite.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace sysid {
namespace {

constexpr ValueRange anything{-infinity, infinity};
constexpr ValueRange nothing{infinity, -infinity, true};

/// Around some values; a NaN among them, as of zero times infinity, may be any number.
ValueRange around(std::initializer_list<double> values) {
  ValueRange range{infinity, -infinity};
  for (double const value : values) {
    if (std::isnan(value)) return anything;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  }
  return range;
}

/// Zero times infinity is a limit of products that are zero.
double product(double a, double b) { return a == 0 || b == 0 ? 0 : a * b; }

ValueRange times(ValueRange const& a, ValueRange const& b) {
  return around({product(a.low, b.low), product(a.low, b.high), product(a.high, b.low), product(a.high, b.high)});
}

ValueRange inverse(ValueRange const& a) {
  if (a.low < 0 && a.high > 0) return anything;
  if (a.low == 0 && a.high == 0) return nothing;
  return {a.high == 0 ? -infinity : 1 / a.high, a.low == 0 ? infinity : 1 / a.low};
}

ValueRange root(ValueRange const& a) {
  if (a.high < 0) return nothing;
  return {std::sqrt(std::max(0.0, a.low)), std::sqrt(a.high)};
}

ValueRange absolute(ValueRange const& a) {
  double const most = std::max(std::fabs(a.low), std::fabs(a.high));
  if (a.low <= 0 && a.high >= 0) return {0, most};
  return {std::min(std::fabs(a.low), std::fabs(a.high)), most};
}

}  // namespace

ValueRange ValueRanges::of(NodeId root) {
  for (NodeId const id : graph_.reachable({&root, 1}))
    if (!known_.contains(id)) known_[id] = of_operation(Node(graph_[id]));
  return known_.at(root);
}

ValueRange ValueRanges::of_parameter(int index) {
  Parameter const& parameter = model_.parameters[static_cast<std::size_t>(index)];
  if (parameter.value) {
    auto const number = graph_.constant_value(*parameter.value);
    return number && !parameter.per_experiment ? ValueRange{*number, *number} : anything;
  }
  if (!parameter.prior) return anything;
  Support const bounds = support(graph_, *parameter.prior);
  ValueRange range = anything;
  if (bounds.lower)
    if (ValueRange const lower = of(*bounds.lower); !lower.empty) range.low = lower.low;
  if (bounds.upper)
    if (ValueRange const upper = of(*bounds.upper); !upper.empty) range.high = upper.high;
  return range;
}

ValueRange ValueRanges::of_operation(Node const& node) {
  if (node.operation == Operation::constant) return std::isnan(node.value) ? anything : ValueRange{node.value, node.value};
  if (node.operation == Operation::leaf) return node.leaf_kind == LeafKind::parameter ? of_parameter(node.index) : anything;
  auto const operand = [&](NodeId id) { return known_.at(id); };
  switch (node.operation) {
    case Operation::negate: {
      ValueRange const a = operand(node.a);
      return a.empty ? a : ValueRange{-a.high, -a.low};
    }
    case Operation::square_root:
    case Operation::absolute: {
      ValueRange const a = operand(node.a);
      return a.empty ? a : node.operation == Operation::absolute ? absolute(a) : root(a);
    }
    case Operation::add:
    case Operation::subtract:
    case Operation::multiply:
    case Operation::divide:
    case Operation::minimum:
    case Operation::maximum: {
      ValueRange const a = operand(node.a), b = operand(node.b);
      if (a.empty || b.empty) return nothing;
      if (node.operation == Operation::add) return {a.low + b.low, a.high + b.high};
      if (node.operation == Operation::subtract) return {a.low - b.high, a.high - b.low};
      if (node.operation == Operation::multiply) return node.a == node.b ? times(absolute(a), absolute(a)) : times(a, b);
      if (node.operation == Operation::minimum) return {std::min(a.low, b.low), std::min(a.high, b.high)};
      if (node.operation == Operation::maximum) return {std::max(a.low, b.low), std::max(a.high, b.high)};
      ValueRange const over = inverse(b);
      return over.empty ? over : times(a, over);
    }
    case Operation::power: {
      ValueRange const a = operand(node.a);
      auto const exponent = graph_.constant_value(node.b);
      if (a.empty) return a;
      return a.low >= 0 || (exponent && std::fmod(*exponent, 2) == 0) ? ValueRange{0, infinity} : anything;
    }
    default:
      return anything;
  }
}

}  // namespace sysid
