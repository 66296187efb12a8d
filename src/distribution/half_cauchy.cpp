// The half-Cauchy distribution: the absolute value of a Cauchy variate around 0.
#include "core/numeric/elementary.hpp"
#include "distribution/rows.hpp"

namespace sysid {
namespace half_cauchy_parts {

constexpr Spelling scale[] = {{"scale", 1, nullptr}};
constexpr ArgumentRow arguments[] = {{scale, must_be_given}};

/// log of the half-Cauchy density; `half_cauchy(scale)` in a model.
///
///   log p = log(2 / pi) - log scale - log(1 + (x/scale)^2),   x >= 0                                 Gelman 2006, Bayesian
///   Analysis 1, 515
///
/// x, scale (the median): unit u; scale > 0.
NodeId log_density(Graph& graph, NodeId x, Nodes a) {
  Term const s(graph, a[0]), z = Term(graph, x) / s;
  double const log_two_over_pi = 2 * std::numbers::ln2 - 2 * half_log_two_pi;
  Term const tail = log1p(z * z);
  return (log_two_over_pi - log(s) - tail).id;
}

NodeId cumulative(Graph& graph, NodeId x, Nodes a) {
  return (2 * std::numbers::inv_pi * atan(Term(graph, x) / Term(graph, a[0]))).id;
}
NodeId survival(Graph& graph, NodeId x, Nodes a) {
  return (2 * std::numbers::inv_pi * atan(Term(graph, a[0]) / Term(graph, x))).id;
}

double quantile(double probability, Tail tail, Numbers a) {
  double const tangent = elementary::tan(std::numbers::pi / 2 * probability);
  return tail == Tail::lower ? a[0] * tangent : a[0] / tangent;
}
double draw(Stream& stream, Numbers a) { return quantile(stream.uniform(), Tail::lower, a); }

std::string_view refuse(Numbers a) { return positive(a[0]) ? std::string_view() : "the scale must be positive"; }

}  // namespace half_cauchy_parts

DistributionRow half_cauchy_distribution() {
  using namespace half_cauchy_parts;
  return {.name = "half_cauchy",
          .arguments = arguments,
          .log_density = &log_density,
          .cumulative = &cumulative,
          .survival = &survival,
          .lower = &zero_bound,
          .draw = &draw,
          .quantile = &quantile,
          .widen = &widen_argument<0>,
          .refuse = &refuse,
          .summary = "half-Cauchy, for scales of hierarchical models"};
}

}  // namespace sysid
