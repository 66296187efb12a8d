// The Poisson distribution: counts of independent events.
#include "core/numeric/elementary.hpp"
#include "distribution/counts.hpp"

namespace sysid {
namespace poisson_parts {

constexpr Spelling mean[] = {{"mean", 1, nullptr}};
constexpr ArgumentRow arguments[] = {{mean, must_be_given}};

/// log of the Poisson probability; `poisson(mean)` in a model.
///
///   log p = y log mean - mean - log y!                                                       Gelman et al. 2013, app. A
///
/// y: a whole number >= 0; mean >= 0, both pure numbers. A mean of 0 gives a count of 0 for certain.
NodeId log_density(Graph& graph, NodeId x, Nodes a) {
  Term const y(graph, x), mu(graph, a[0]);
  Term const factorial = lgamma(y + 1.0);
  return (count_times_log(y, mu) - mu - factorial).id;
}

NodeId centre(Graph&, Nodes a) { return a[0]; }
/// The mean that makes y likeliest is y.
NodeId saturated(Graph& graph, NodeId x, Nodes) { return log_density(graph, x, {&x, 1}); }

double draw(Stream& stream, Numbers a) { return poisson_variate(a[0], stream); }
double variance(Numbers a) { return a[0]; }
double excess_kurtosis(Numbers a) { return 1 / a[0]; }

NoiseMoments moments(Numbers a) { return {a[0], a[0]}; }

std::string_view refuse(Numbers a) {
  if (!(a[0] >= 0 && a[0] <= largest_mean)) return "the mean must be zero or positive, and at most 1e15";
  return {};
}

}  // namespace poisson_parts

/// Numbers below 10 by inversion, one probability after the other; from there on by transformed rejection with squeeze (PTRS),
/// Hoermann 1993, "The transformed rejection method for generating Poisson random variables", Insurance: Math. and Econ. 12.
double poisson_variate(double mean, Stream& stream) {
  if (mean < 10) {
    double left = stream.uniform(), probability = elementary::exp(-mean), count = 0;
    while (left > probability && probability > 0) {
      left -= probability;
      count += 1;
      probability *= mean / count;
    }
    return count;
  }
  double const b = 0.931 + 2.53 * std::sqrt(mean), a = -0.059 + 0.02483 * b;
  double const log_inverse_alpha = elementary::log(1.1239 + 1.1328 / (b - 3.4)), squeeze = 0.9277 - 3.6224 / (b - 2);
  double const log_mean = elementary::log(mean);
  for (;;) {
    double const u = stream.uniform() - 0.5, v = stream.uniform(), edge = 0.5 - std::fabs(u);
    double const count = std::floor((2 * a / edge + b) * u + mean + 0.43);
    if (edge >= 0.07 && v <= squeeze) return count;
    if (count < 0 || (edge < 0.013 && v > edge)) continue;
    double const log_v = elementary::log(v) + log_inverse_alpha - elementary::log(a / (edge * edge) + b);
    if (log_v <= count * log_mean - mean - elementary::lgamma(count + 1)) return count;
  }
}

DistributionRow poisson_distribution() {
  using namespace poisson_parts;
  return {.name = "poisson",
          .arguments = arguments,
          .noise = true,
          .dimensionless = true,
          .log_density = &log_density,
          .lower = &zero_bound,
          .centre = &centre,
          .saturated = &saturated,
          .draw = &draw,
          .refuse = &refuse,
          .summary = "Poisson: counts, by mean; noise only",
          .discrete = true,
          .variance = &variance,
          .excess_kurtosis = &excess_kurtosis,
          .moments = &moments};
}

}  // namespace sysid
