// Student's t with location and scale: noise with outliers.
#include <boost/math/special_functions/beta.hpp>

#include "core/numeric/elementary.hpp"
#include "distribution/rows.hpp"
#include "function/boost_policy.hpp"

namespace sysid {
namespace student_t_parts {

/// sd^2 = variance = 1/precision = scale^2 n/(n - 2), n > 2: below, the variance is infinite and the scale NaN, which is refused.
NodeId scale_from_sd(Graph& graph, NodeId sd, Nodes before) {
  Term const n(graph, before[1]);
  return (Term(graph, sd) * sqrt((n - 2.0) / n)).id;
}
NodeId scale_from_variance(Graph& graph, NodeId variance, Nodes before) {
  return scale_from_sd(graph, sd_from_variance(graph, variance, before), before);
}
NodeId scale_from_precision(Graph& graph, NodeId precision, Nodes before) {
  return scale_from_sd(graph, sd_from_precision(graph, precision, before), before);
}

constexpr Spelling location[] = {{"location", 1, nullptr}};
constexpr Spelling degrees_of_freedom[] = {{"degrees_of_freedom", 0, nullptr}};
constexpr Spelling scale[] = {{"scale", 1, nullptr},
                              {"sd", 1, &scale_from_sd},
                              {"variance", 2, &scale_from_variance},
                              {"precision", -2, &scale_from_precision}};
constexpr ArgumentRow arguments[] = {{location, must_be_given}, {degrees_of_freedom, must_be_given}, {scale, must_be_given}};

/// log Gamma((n+1)/2) - log Gamma(n/2). Above n = 100 the two terms cancel and the asymptotic series in x = n/2 stands for them,
///
///   1/2 log x - 1/(8 x) + 1/(192 x^3) - 1/(640 x^5) + 17/(14336 x^7)                                from DLMF 5.11.1
///
/// whose next term is below 1e-18.
Term log_gamma_ratio(Term n) {
  Term const x = n / 2.0;
  Term const w = 1.0 / (x * x);
  Term const rest = (1. / 8 - w * (1. / 192 - w * (1. / 640 - w * (17. / 14336)))) / x, series = 0.5 * log(x) - rest;
  Term const of_x = lgamma(x), direct = lgamma((n + 1.0) / 2.0) - of_x;
  return select(less(n, 100.0), direct, series);
}

Term constant(Term n, Term s) {
  Term const log_s = log(s), of_n = 0.5 * log(n * std::numbers::pi);
  return log_gamma_ratio(n) - of_n - log_s;
}

/// log of Student's t; `student_t(location, degrees_of_freedom, scale | sd | variance | precision = ...)` in a model.
///
///   log p = log Gamma((n+1)/2) - log Gamma(n/2) - 1/2 log(n pi) - log scale - (n+1)/2 log(1 + z^2/n),   z = (x - location)/scale
///                                                                                                       Gelman et al. 2013, app. A
/// x, location, scale, sd: unit u; variance: u^2; precision: u^-2; n = degrees_of_freedom > 0 a pure number, scale > 0. The scale
/// is canonical because it exists for every n. `precision` is 1/variance, as for every distribution here; Bishop (2006, eq. 2.159)
/// calls 1/scale^2 so.
NodeId log_density(Graph& graph, NodeId x, Nodes a) {
  Term const r = Term(graph, x) - Term(graph, a[0]), n(graph, a[1]), s(graph, a[2]);
  Term const weight = 1.0 / (n * s * s), tail = log1p(r * r * weight), power = (n + 1.0) / 2.0 * tail;
  return (constant(n, s) - power).id;
}

Term standardised(Graph& graph, NodeId x, Nodes a) { return (Term(graph, x) - Term(graph, a[0])) / Term(graph, a[2]); }
NodeId cumulative(Graph& graph, NodeId x, Nodes a) { return student_t_cdf(standardised(graph, x, a), Term(graph, a[1])).id; }
NodeId survival(Graph& graph, NodeId x, Nodes a) { return student_t_cdf(-standardised(graph, x, a), Term(graph, a[1])).id; }
NodeId centre(Graph&, Nodes a) { return a[0]; }
NodeId saturated(Graph& graph, NodeId, Nodes a) { return constant(Term(graph, a[1]), Term(graph, a[2])).id; }

/// Z / sqrt(2 G / n), Z standard normal, G of the gamma distribution with shape n/2.
double draw(Stream& stream, Numbers a) {
  double const z = stream.normal();
  double const half_log_chi = 0.5 * (log_standard_gamma(a[1] / 2, stream) + elementary::log(2 / a[1]));
  return a[0] + a[2] * z * elementary::exp(-half_log_chi);
}

/// By Boost's inverse of the incomplete beta function, exempt from equality across processors: 2 P(T > t) = I_y(n/2, 1/2), y = n/(n
/// + t^2).
double quantile(double probability, Tail tail, Numbers a) {
  if (probability > 0.5) {  // counted on the other side
    probability = 1 - probability;
    tail = tail == Tail::lower ? Tail::upper : Tail::lower;
  }
  double complement = 0;
  double const y = boost::math::ibeta_inv(a[1] / 2, 0.5, 2 * probability, &complement, BoostPolicy());
  double const t = std::sqrt(a[1] * complement / y);
  return a[0] + a[2] * (tail == Tail::lower ? -t : t);
}

/// The mean does not exist for n <= 1; the location, which is the median, stands for it. The variance is infinite for n <= 2.
NoiseMoments moments(Numbers a) {
  double const n = a[1];
  return {a[0], n > 2 ? a[2] * a[2] * n / (n - 2) : std::numeric_limits<double>::infinity()};
}

std::string_view refuse(Numbers a) {
  if (!std::isfinite(a[0])) return "the location must be finite";
  if (!positive(a[1])) return "degrees_of_freedom must be positive";
  if (!positive(a[2])) return "the scale must be positive; sd, variance and precision also need degrees_of_freedom above 2";
  return {};
}

}  // namespace student_t_parts

DistributionRow student_t_distribution() {
  using namespace student_t_parts;
  return {.name = "student_t",
          .arguments = arguments,
          .noise = true,
          .log_density = &log_density,
          .cumulative = &cumulative,
          .survival = &survival,
          .centre = &centre,
          .saturated = &saturated,
          .draw = &draw,
          .quantile = &quantile,
          .widen = &widen_argument<2>,
          .refuse = &refuse,
          .summary = "Student's t, by scale, sd, variance or precision: heavy tails, for data with outliers",
          .moments = &moments};
}

}  // namespace sysid
