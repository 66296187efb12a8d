// The negative binomial distribution: counts that scatter more than Poisson's.
#include "core/numeric/elementary.hpp"
#include "distribution/counts.hpp"

namespace sysid {
namespace negative_binomial_parts {

NodeId shape_from_overdispersion(Graph& graph, NodeId overdispersion, Nodes) { return (1.0 / Term(graph, overdispersion)).id; }

constexpr Spelling mean[] = {{"mean", 1, nullptr}};
constexpr Spelling shape[] = {{"shape", 0, nullptr}, {"overdispersion", 0, &shape_from_overdispersion}};
constexpr ArgumentRow arguments[] = {{mean, must_be_given}, {shape, must_be_given}};

/// Stirling's series of log Gamma(x) beyond (x - 1/2) log x - x + log(2 pi)/2, DLMF 5.11.1; the next term is below 2e-15 for x
/// >= 20.
Term stirling_rest(Term x) {
  Term const w = 1.0 / (x * x);
  return (1. / 12 - w * (1. / 360 - w * (1. / 1260 - w * (1. / 1680)))) / x;
}

/// log Gamma(r + y) - log Gamma(r) - y log r. From r = 20 on by Stirling's series, where the terms would cancel.
Term log_rising_ratio(Term y, Term r) {
  Term const rest_of_r = stirling_rest(r), rests = stirling_rest(r + y) - rest_of_r;
  Term const log_ratio = log1p(y / r), series = (r + y - 0.5) * log_ratio - y + rests;
  Term const power = y * log(r), of_r = lgamma(r), direct = lgamma(r + y) - of_r - power;
  return select(less(r, 20.0), direct, series);
}

/// log of the negative binomial probability; `negative_binomial(mean, shape | overdispersion = ...)` in a model: a Poisson count
/// whose mean is itself gamma distributed with this shape.
///
///   log p = log Gamma(y + r) - log Gamma(r) - log y! + y log(mean/r) - (y + r) log(1 + mean/r),   variance = mean + mean^2/r
///                                                                            Hilbe 2011, Negative Binomial Regression, eq. 8.9
///
/// y: a whole number >= 0; mean >= 0; r = shape = 1/overdispersion > 0: all pure numbers. Poisson's is the limit of a large shape.
NodeId log_density(Graph& graph, NodeId x, Nodes a) {
  Term const y(graph, x), mu(graph, a[0]), r(graph, a[1]);
  Term const log_ratio = log1p(mu / r), power = (y + r) * log_ratio, of_mean = count_times_log(y, mu), factorial = lgamma(y + 1.0);
  return (log_rising_ratio(y, r) - factorial + of_mean - power).id;
}

NodeId centre(Graph&, Nodes a) { return a[0]; }
/// Of all means with this shape, y makes y likeliest.
NodeId saturated(Graph& graph, NodeId x, Nodes a) {
  NodeId const best[] = {x, a[1]};
  return log_density(graph, x, best);
}

double draw(Stream& stream, Numbers a) {
  return poisson_variate(std::min(a[0] / a[1] * elementary::exp(log_standard_gamma(a[1], stream)), largest_mean), stream);
}
double variance(Numbers a) { return a[0] + a[0] * a[0] / a[1]; }
double excess_kurtosis(Numbers a) { return 6 / a[1] + 1 / variance(a); }

NoiseMoments moments(Numbers a) { return {a[0], variance(a)}; }

std::string_view refuse(Numbers a) {
  if (!(a[0] >= 0 && a[0] <= largest_mean)) return "the mean must be zero or positive, and at most 1e15";
  if (!positive(a[1])) return "shape or overdispersion must be positive";
  return {};
}

}  // namespace negative_binomial_parts

DistributionRow negative_binomial_distribution() {
  using namespace negative_binomial_parts;
  return {.name = "negative_binomial",
          .arguments = arguments,
          .noise = true,
          .dimensionless = true,
          .log_density = &log_density,
          .lower = &zero_bound,
          .centre = &centre,
          .saturated = &saturated,
          .draw = &draw,
          .refuse = &refuse,
          .summary = "negative binomial: overdispersed counts, by its mean and one of shape and overdispersion; noise only",
          .discrete = true,
          .variance = &variance,
          .excess_kurtosis = &excess_kurtosis,
          .moments = &moments};
}

}  // namespace sysid
