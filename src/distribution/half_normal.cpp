// The half-normal distribution: the absolute value of a normal variate with mean 0.
#include "distribution/rows.hpp"

namespace sysid {
namespace half_normal_parts {

constexpr Spelling sd[] = {{"sd", 1, nullptr}};
constexpr ArgumentRow arguments[] = {{sd, must_be_given}};

/// log of the density of |X|, X normal with mean 0 and the given sd (not the sd of |X|); `half_normal(sd)`.
///
///   log p = 1/2 log(2 / pi) - log sd - 1/2 (x/sd)^2,   x >= 0                            Johnson, Kotz, Balakrishnan 1994,
///   eq. 13.90
///
/// x, sd: unit u; sd > 0.
NodeId log_density(Graph& graph, NodeId x, Nodes a) {
  Term const value(graph, x), s(graph, a[0]);
  Term const weight = 0.5 / (s * s), square = value * value * weight;
  return (std::numbers::ln2 - half_log_two_pi - log(s) - square).id;
}

Term scaled(Graph& graph, NodeId x, Nodes a) { return Term(graph, x) / Term(graph, a[0]) / std::numbers::sqrt2; }
NodeId cumulative(Graph& graph, NodeId x, Nodes a) { return erf(scaled(graph, x, a)).id; }
NodeId survival(Graph& graph, NodeId x, Nodes a) { return erfc(scaled(graph, x, a)).id; }

double draw(Stream& stream, Numbers a) { return a[0] * std::fabs(stream.normal()); }
double quantile(double probability, Tail tail, Numbers a) {
  if (tail == Tail::lower) return a[0] * standard_normal_quantile_from_middle(probability / 2);
  return a[0] * standard_normal_quantile(probability / 2, Tail::upper);
}

std::string_view refuse(Numbers a) { return positive(a[0]) ? std::string_view() : "sd must be positive"; }

}  // namespace half_normal_parts

DistributionRow half_normal_distribution() {
  using namespace half_normal_parts;
  return {.name = "half_normal",
          .arguments = arguments,
          .log_density = &log_density,
          .cumulative = &cumulative,
          .survival = &survival,
          .lower = &zero_bound,
          .draw = &draw,
          .quantile = &quantile,
          .widen = &widen_argument<0>,
          .refuse = &refuse,
          .summary = "absolute value of a normal variate with mean 0"};
}

}  // namespace sysid
