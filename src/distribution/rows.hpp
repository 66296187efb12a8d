// What the files of one distribution each share: their rows, spellings, checks of arguments and the variates several of them need.
#pragma once
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numeric/normal_quantile.hpp"
#include "distribution/distribution.hpp"
#include "distribution/list.hpp"
#include "function/primitive.hpp"

namespace sysid {

#define DECLARE_ROW(name) DistributionRow name##_distribution();
SYSID_DISTRIBUTIONS(DECLARE_ROW)
#undef DECLARE_ROW

using Nodes = std::span<NodeId const>;
using Numbers = std::span<double const>;

constexpr double must_be_given = std::numeric_limits<double>::quiet_NaN();
/// log(2 pi) / 2.
constexpr double half_log_two_pi = 0.91893853320467274178;

/// Zero as a natural bound of a support.
inline NodeId zero_bound(Graph& graph, Nodes) { return graph.constant(0); }

/// sd from variance or precision.
inline NodeId sd_from_variance(Graph& graph, NodeId variance, Nodes) { return sqrt(Term(graph, variance)).id; }
inline NodeId sd_from_precision(Graph& graph, NodeId precision, Nodes) { return (1.0 / sqrt(Term(graph, precision))).id; }

/// For `widen`: the width is proportional to one argument.
template <std::size_t argument>
void widen_argument(double factor, std::span<double> arguments) {
  arguments[argument] *= factor;
}

inline bool positive(double x) { return x > 0 && x < std::numeric_limits<double>::infinity(); }

/// P(Z <= z) and P(Z > z) of the standard normal, each accurate where it is small: erfc(-+z / sqrt 2) / 2.                DLMF 7.18
inline Term standard_normal_lower(Term z) { return 0.5 * erfc(-(z / std::numbers::sqrt2)); }
inline Term standard_normal_upper(Term z) { return 0.5 * erfc(z / std::numbers::sqrt2); }
inline double standard_normal_quantile(double probability, Tail tail) {
  double const z = standard_normal_quantile(probability);
  return tail == Tail::lower ? z : -z;
}

/// log of a gamma variate of scale 1; shape > 0. The logarithm, because for a small shape the variate underflows.
double log_standard_gamma(double shape, Stream& stream);

}  // namespace sysid
