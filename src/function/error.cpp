// The error function and its complement: primitives and derivatives.
//
//   erf(x) = 2/sqrt(pi) integral_0^x exp(-t^2) dt,   erfc = 1 - erf, accurate in the upper tail          DLMF 7.2.1, 7.2.2
#include "function/primitive.hpp"

#include <numbers>

namespace sysid {
namespace {

Term bell(Term x) { return 2.0 * std::numbers::inv_sqrtpi * exp(-(x * x)); }
NodeId erf_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) { return bell(Term(graph, a)).id; }
NodeId erfc_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) { return (-bell(Term(graph, a))).id; }

}  // namespace

Function const erf_function{"erf", 1, &elementary::erf, &elementary::erf_lanes, nullptr, nullptr, &erf_derivative};
Function const erfc_function{"erfc", 1, &elementary::erfc, &elementary::erfc_lanes, nullptr, nullptr, &erfc_derivative};

}  // namespace sysid
