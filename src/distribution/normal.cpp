// The normal distribution.
#include "distribution/rows.hpp"

namespace sysid {
namespace normal_parts {

constexpr Spelling mean[] = {{"mean", 1, nullptr}};
constexpr Spelling sd[] = {{"sd", 1, nullptr}, {"variance", 2, &sd_from_variance}, {"precision", -2, &sd_from_precision}};
constexpr ArgumentRow arguments[] = {{mean, must_be_given}, {sd, must_be_given}};

Term constant(Term s) { return -half_log_two_pi - log(s); }

/// log N(x | mean, sd); `normal(mean, sd | variance | precision = ...)` in a model.
///
///   log p = -1/2 log(2 pi) - log sd - 1/2 ((x - mean)/sd)^2,   precision = 1/variance = 1/sd^2          Bishop 2006,
///   eq. 1.46, 1.48
///
/// x, mean, sd: unit u; variance: u^2; precision: u^-2; sd > 0. All but (x - mean)^2 is work per parameter, not per sample.
NodeId log_density(Graph& graph, NodeId x, Nodes a) {
  Term const r = Term(graph, x) - Term(graph, a[0]), s(graph, a[1]);
  Term const weight = 0.5 / (s * s), square = r * r * weight;
  return (constant(s) - square).id;
}

Term standardised(Graph& graph, NodeId x, Nodes a) { return (Term(graph, x) - Term(graph, a[0])) / Term(graph, a[1]); }
NodeId cumulative(Graph& graph, NodeId x, Nodes a) { return standard_normal_lower(standardised(graph, x, a)).id; }
NodeId survival(Graph& graph, NodeId x, Nodes a) { return standard_normal_upper(standardised(graph, x, a)).id; }
NodeId centre(Graph&, Nodes a) { return a[0]; }
NodeId saturated(Graph& graph, NodeId, Nodes a) { return constant(Term(graph, a[1])).id; }

double draw(Stream& stream, Numbers a) { return a[0] + a[1] * stream.normal(); }
double quantile(double probability, Tail tail, Numbers a) { return a[0] + a[1] * standard_normal_quantile(probability, tail); }

NoiseMoments moments(Numbers a) { return {a[0], a[1] * a[1]}; }

std::string_view refuse(Numbers a) {
  if (!std::isfinite(a[0])) return "the mean must be finite";
  if (!positive(a[1])) return "sd, variance or precision must be positive";
  return {};
}

}  // namespace normal_parts

DistributionRow normal_distribution() {
  using namespace normal_parts;
  return {.name = "normal",
          .arguments = arguments,
          .noise = true,
          .gaussian = true,
          .log_density = &log_density,
          .cumulative = &cumulative,
          .survival = &survival,
          .centre = &centre,
          .saturated = &saturated,
          .draw = &draw,
          .quantile = &quantile,
          .widen = &widen_argument<1>,
          .refuse = &refuse,
          .summary = "normal, by sd, variance or precision",
          .moments = &moments};
}

}  // namespace sysid
