// The log-normal distribution: the logarithm of x is normal.
#include "core/numeric/elementary.hpp"
#include "distribution/rows.hpp"

namespace sysid {
namespace log_normal_parts {

constexpr Spelling median[] = {{"median", 1, nullptr}, {"log_mean", 0, nullptr, true}};
constexpr Spelling sd[] = {
    {"sd", 0, nullptr}, {"log_sd", 0, nullptr}, {"variance", 0, &sd_from_variance}, {"precision", 0, &sd_from_precision}};
constexpr ArgumentRow arguments[] = {{median, must_be_given, true}, {sd, must_be_given}};

Term constant(Term x, Term s) {
  Term const log_x = log(x);
  return -half_log_two_pi - log(s) - log_x;
}

/// log of the density of x where log(x / median) is normal with mean 0 and the given sd; `log_normal(median | log_mean = ..., sd |
/// log_sd | variance | precision = ...)`.
///
///   log p = -1/2 log(2 pi) - log sd - log x - 1/2 (log(x / median)/sd)^2                Johnson, Kotz, Balakrishnan 1994,
///   eq. 14.2'
///
/// x > 0 and median > 0: unit u; sd, variance, precision: of the logarithm, pure numbers; sd > 0. The median is exp of the usual
/// mu, so that it has x's unit; log_mean is mu of the number that x is in its declared unit.
NodeId log_density(Graph& graph, NodeId x, Nodes a) {
  Term const value(graph, x), s(graph, a[1]);
  Term const log_median = log(Term(graph, a[0])), r = log(value) - log_median;
  Term const weight = 0.5 / (s * s), square = r * r * weight;
  return (constant(value, s) - square).id;
}

Term standardised(Graph& graph, NodeId x, Nodes a) {
  Term const log_median = log(Term(graph, a[0]));
  return (log(Term(graph, x)) - log_median) / Term(graph, a[1]);
}
NodeId cumulative(Graph& graph, NodeId x, Nodes a) { return standard_normal_lower(standardised(graph, x, a)).id; }
NodeId survival(Graph& graph, NodeId x, Nodes a) { return standard_normal_upper(standardised(graph, x, a)).id; }
NodeId centre(Graph&, Nodes a) { return a[0]; }
NodeId saturated(Graph& graph, NodeId x, Nodes a) { return constant(Term(graph, x), Term(graph, a[1])).id; }

double draw(Stream& stream, Numbers a) { return a[0] * elementary::exp(a[1] * stream.normal()); }
double quantile(double probability, Tail tail, Numbers a) {
  return a[0] * elementary::exp(a[1] * standard_normal_quantile(probability, tail));
}

/// median exp(sd^2/2), median^2 exp(sd^2) (exp(sd^2) - 1).
NoiseMoments moments(Numbers a) {
  double const growth = elementary::exp(a[1] * a[1]);
  return {a[0] * std::sqrt(growth), a[0] * a[0] * growth * elementary::expm1(a[1] * a[1])};  // 1 of exp hides a small sd
}

std::string_view refuse(Numbers a) {
  if (!positive(a[0])) return "the median must be positive";
  if (!positive(a[1])) return "sd, variance or precision of the logarithm must be positive";
  return {};
}

}  // namespace log_normal_parts

DistributionRow log_normal_distribution() {
  using namespace log_normal_parts;
  return {.name = "log_normal",
          .arguments = arguments,
          .noise = true,
          .log_density = &log_density,
          .cumulative = &cumulative,
          .survival = &survival,
          .lower = &zero_bound,
          .centre = &centre,
          .saturated = &saturated,
          .draw = &draw,
          .quantile = &quantile,
          .widen = &widen_argument<1>,
          .refuse = &refuse,
          .summary = "log-normal, by its median or log_mean, and by the sd (log_sd), variance or precision of the logarithm",
          .moments = &moments};
}

}  // namespace sysid
