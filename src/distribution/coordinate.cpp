// From a parameter's support to the whole line, where samplers move, and back.
#include <cmath>
#include <limits>

#include "distribution/distribution.hpp"
#include "function/primitive.hpp"

namespace sysid {
namespace {

constexpr double unit_roundoff = std::numeric_limits<double>::epsilon();

/// x, but at least one rounding above or below the bound: there some densities are infinite. A NaN stays one (the order of the
/// operands).
Term above(Term bound, Term x) { return max(bound + abs(bound) * unit_roundoff, x); }
Term below(Term bound, Term x) { return min(bound - abs(bound) * unit_roundoff, x); }

/// Bounds at infinity are none.
std::optional<NodeId> finite(Graph const& graph, std::optional<NodeId> bound) {
  if (!bound) return bound;
  std::optional<double> const value = graph.constant_value(*bound);
  return value && std::isinf(*value) ? std::nullopt : bound;
}

}  // namespace

Support support(Graph& graph, Distribution const& use) {
  auto const natural = [&](auto bound) { return bound == nullptr ? std::nullopt : std::optional(bound(graph, use.arguments)); };
  std::optional<NodeId> lower = natural(use.row->lower), upper = natural(use.row->upper);
  if (std::optional<NodeId> const user = finite(graph, use.lower))
    lower = lower ? graph.binary(Operation::maximum, *lower, *user) : *user;
  if (std::optional<NodeId> const user = finite(graph, use.upper))
    upper = upper ? graph.binary(Operation::minimum, *upper, *user) : *user;
  return {lower, upper, use.row->logarithmic && lower && upper};
}

/// Between a and b, with q = e^-|u| / (1 + e^-|u|), the distance to the nearer end as a share of the whole:
///
///   x = a + (b - a) q for u < 0, b - (b - a) q otherwise;   log |dx/du| = log(b - a) - |u| - 2 log(1 + e^-|u|)
///
/// which equals a + (b - a)/(1 + e^-u) (Stan Reference Manual, "Lower and upper bounded scalar") without its overflow and
/// cancellation. On the logarithmic scale L = log b - log a: x = a e^(L q) or b e^(-L q), log |dx/du| = log x + log L - |u| - 2
/// log(1 + e^-|u|).
Coordinate constrain(Graph& graph, Support const& support, NodeId coordinate) {
  Term const u(graph, coordinate);
  if (!support.lower && !support.upper) return {coordinate, graph.constant(0)};
  if (!support.upper) {
    Term const a(graph, *support.lower);
    return {above(a, a + exp(u)).id, coordinate};
  }
  if (!support.lower) {
    Term const b(graph, *support.upper);
    return {below(b, b - exp(u)).id, coordinate};
  }
  Term const a(graph, *support.lower), b(graph, *support.upper);
  Term const left = less(u, 0.0);
  Term const distance = abs(u);
  Term const e = exp(-distance);
  Term const q = e / (1.0 + e);
  Term const bend = 2.0 * log1p(e), log_slope = -distance - bend;
  if (!support.logarithmic) {
    Term const width = b - a, from_upper = below(b, b - width * q), from_lower = above(a, a + width * q);
    return {select(left, from_lower, from_upper).id, (log(width) + log_slope).id};
  }
  Term const log_a = log(a), log_b = log(b), width = log_b - log_a;
  Term const offset = select(left, width * q, -(width * q));
  Term const factor = exp(offset), x = select(left, a, b) * factor;
  Term const log_x = select(left, log_a, log_b) + offset;
  Term const from_upper = below(b, x), from_lower = above(a, x);
  return {select(left, from_lower, from_upper).id, (log_x + log(width) + log_slope).id};
}

NodeId unconstrain(Graph& graph, Support const& support, NodeId value) {
  Term const x(graph, value);
  if (!support.lower && !support.upper) return value;
  if (!support.upper) return log(x - Term(graph, *support.lower)).id;
  if (!support.lower) return log(Term(graph, *support.upper) - x).id;
  Term const a(graph, *support.lower), b(graph, *support.upper);
  if (!support.logarithmic) {
    Term const to_upper = log(b - x), to_lower = log(x - a);
    return (to_lower - to_upper).id;
  }
  // log(x/a) and log(b/x), exact near the ends.
  Term const to_upper = log(log1p((b - x) / x)), to_lower = log(log1p((x - a) / a));
  return (to_lower - to_upper).id;
}

}  // namespace sysid
