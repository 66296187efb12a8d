// sinh, cosh, tanh: primitives and derivatives.
#include "function/primitive.hpp"

namespace sysid {
namespace {

NodeId sinh_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) { return cosh(Term(graph, a)).id; }
NodeId cosh_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) { return sinh(Term(graph, a)).id; }
NodeId tanh_derivative(Graph& graph, NodeId call, NodeId, NodeId, int) {
  Term const tangent(graph, call);
  Term const above = 1.0 + tangent;
  return ((1.0 - tangent) * above).id;
}

}  // namespace

Function const sinh_function{"sinh", 1, &elementary::sinh, &elementary::sinh_lanes, nullptr, nullptr, &sinh_derivative};
Function const cosh_function{"cosh", 1, &elementary::cosh, &elementary::cosh_lanes, nullptr, nullptr, &cosh_derivative};
Function const tanh_function{"tanh", 1, &elementary::tanh, &elementary::tanh_lanes, nullptr, nullptr, &tanh_derivative};

}  // namespace sysid
