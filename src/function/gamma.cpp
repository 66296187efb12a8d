// log |Gamma(x)| and its derivative psi(x) = d/dx log Gamma(x): primitives.
#include "function/primitive.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace sysid {
namespace {

NodeId lgamma_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) { return graph.call(digamma_function, a); }

}  // namespace

/// psi(x), by the recurrence psi(x) = psi(x + 1) - 1/x up to x >= 10 and there the asymptotic series
///
///   psi(x) = log x - 1/(2 x) - sum_k B_2k / (2 k x^2k)                                                   DLMF 5.5.2, 5.11.2
///
/// to k = 7 (the next term is below 5e-17); for x < 0 the reflection psi(1 - x) - pi / tan(pi x), DLMF 5.5.4. NaN at the poles.
double digamma(double x) {
  if (!(x > 0)) {
    if (x == std::floor(x) || std::isnan(x)) return std::numeric_limits<double>::quiet_NaN();
    double const part = x - std::floor(x);  // tan has period pi; the argument stays small
    return digamma(1 - x) - std::numbers::pi / elementary::tan(std::numbers::pi * part);
  }
  double shift = 0;
  for (; x < 10; x += 1) shift += 1 / x;
  double const w = 1 / (x * x);
  double const series =
      w * (1. / 12 - w * (1. / 120 - w * (1. / 252 - w * (1. / 240 - w * (1. / 132 - w * (691. / 32760 - w * (1. / 12)))))));
  return elementary::log(x) - 0.5 / x - series - shift;
}

Function const lgamma_function{"lgamma", 1, &elementary::lgamma, &elementary::lgamma_lanes, nullptr, nullptr, &lgamma_derivative};
Function const digamma_function{"digamma", 1, &digamma, &over_lanes<&digamma>, nullptr, nullptr, nullptr};

}  // namespace sysid
