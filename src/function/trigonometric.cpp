// sin, cos, tan and their inverses: primitives and derivatives. Angles are in radians, dimensionless as in the SI.
#include "function/primitive.hpp"

namespace sysid {
namespace {

NodeId sin_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) { return cos(Term(graph, a)).id; }
NodeId cos_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) { return (-sin(Term(graph, a))).id; }
NodeId tan_derivative(Graph& graph, NodeId call, NodeId, NodeId, int) {
  Term const tangent(graph, call);
  return (1.0 + tangent * tangent).id;
}

/// sqrt((1 - x)(1 + x)): sqrt(1 - x^2) without the cancellation near |x| = 1.
Term complement(Term x) {
  Term const above = 1.0 + x;
  return sqrt((1.0 - x) * above);
}
NodeId asin_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) { return (1.0 / complement(Term(graph, a))).id; }
NodeId acos_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) { return (-1.0 / complement(Term(graph, a))).id; }
NodeId atan_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) {
  Term const x(graph, a);
  return (1.0 / (1.0 + x * x)).id;
}
NodeId atan2_derivative(Graph& graph, NodeId, NodeId a, NodeId b, int which) {
  Term const y(graph, a), x(graph, b);
  Term const other = y * y, square = x * x + other;
  return (which == 0 ? x / square : -(y / square)).id;
}

}  // namespace

Function const sin_function{"sin", 1, &elementary::sin, &elementary::sin_lanes, nullptr, nullptr, &sin_derivative};
Function const cos_function{"cos", 1, &elementary::cos, &elementary::cos_lanes, nullptr, nullptr, &cos_derivative};
Function const tan_function{"tan", 1, &elementary::tan, &elementary::tan_lanes, nullptr, nullptr, &tan_derivative};
Function const asin_function{"asin", 1, &elementary::asin, &elementary::asin_lanes, nullptr, nullptr, &asin_derivative};
Function const acos_function{"acos", 1, &elementary::acos, &elementary::acos_lanes, nullptr, nullptr, &acos_derivative};
Function const atan_function{"atan", 1, &elementary::atan, &elementary::atan_lanes, nullptr, nullptr, &atan_derivative};
/// atan2(y, x): the angle of the point (x, y), in (-pi, pi].
Function const atan2_function{"atan2", 2, nullptr, nullptr, &elementary::atan2, &elementary::atan2_lanes, &atan2_derivative};

}  // namespace sysid
