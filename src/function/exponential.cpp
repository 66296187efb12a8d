// exp, expm1, log1p, log10: primitives and derivatives. log itself lives in expression/, whose derivatives need it.
#include "function/primitive.hpp"

#include <numbers>

namespace sysid {
namespace {

NodeId exp_derivative(Graph&, NodeId call, NodeId, NodeId, int) { return call; }
NodeId expm1_derivative(Graph& graph, NodeId call, NodeId, NodeId, int) { return (Term(graph, call) + 1.0).id; }
NodeId log1p_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) { return (1.0 / (1.0 + Term(graph, a))).id; }
NodeId log10_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) { return (1.0 / (Term(graph, a) * std::numbers::ln10)).id; }

}  // namespace

Function const exp_function{"exp", 1, &elementary::exp, &elementary::exp_lanes, nullptr, nullptr, &exp_derivative};
/// e^x - 1 without the cancellation near 0.
Function const expm1_function{"expm1", 1, &elementary::expm1, &elementary::expm1_lanes, nullptr, nullptr, &expm1_derivative};
/// log(1 + x) without the cancellation near 0; NaN for x < -1.
Function const log1p_function{"log1p", 1, &elementary::log1p, &elementary::log1p_lanes, nullptr, nullptr, &log1p_derivative};
Function const log10_function{"log10", 1, &elementary::log10, &elementary::log10_lanes, nullptr, nullptr, &log10_derivative};

}  // namespace sysid
