// The uniform distribution and the log-uniform distribution, whose logarithm is uniform.
#include <algorithm>

#include "core/numeric/elementary.hpp"
#include "distribution/rows.hpp"

namespace sysid {
namespace uniform_parts {

constexpr Spelling lower[] = {{"lower", 1, nullptr}};
constexpr Spelling upper[] = {{"upper", 1, nullptr}};
constexpr ArgumentRow arguments[] = {{lower, must_be_given}, {upper, must_be_given}};

NodeId lower_bound(Graph&, Nodes a) { return a[0]; }
NodeId upper_bound(Graph&, Nodes a) { return a[1]; }

/// log of the uniform density; `uniform(lower, upper)` in a model.
///
///   log p = -log(upper - lower),   lower < x < upper                                                       Gelman et al. 2013,
///   app. A
///
/// x, lower, upper: unit u; lower < upper.
NodeId uniform_log_density(Graph& graph, NodeId, Nodes a) { return (-log(Term(graph, a[1]) - Term(graph, a[0]))).id; }
NodeId uniform_cumulative(Graph& graph, NodeId x, Nodes a) {
  Term const low(graph, a[0]);
  Term const width = Term(graph, a[1]) - low;
  return ((Term(graph, x) - low) / width).id;
}
NodeId uniform_survival(Graph& graph, NodeId x, Nodes a) {
  Term const high(graph, a[1]);
  Term const width = high - Term(graph, a[0]);
  return ((high - Term(graph, x)) / width).id;
}
double uniform_quantile(double probability, Tail tail, Numbers a) {
  double const distance = (a[1] - a[0]) * probability;
  return std::clamp(tail == Tail::lower ? a[0] + distance : a[1] - distance, a[0], a[1]);
}
double uniform_draw(Stream& stream, Numbers a) { return uniform_quantile(stream.uniform(), Tail::lower, a); }
/// A bound at zero is the least that the quantity can be, and stays; otherwise the middle does.
void uniform_widen(double factor, std::span<double> a) {
  double const middle = a[0] == 0 || a[1] == 0 ? 0 : 0.5 * a[0] + 0.5 * a[1];
  for (double& bound : a) bound = middle + factor * (bound - middle);
}
std::string_view uniform_refuse(Numbers a) {
  if (!std::isfinite(a[0]) || !std::isfinite(a[1])) return "both bounds must be finite";
  if (!(a[0] < a[1])) return "lower must be below upper";
  return {};
}

/// log(upper / lower).
Term log_width(Graph& graph, Nodes a) {
  Term const log_low = log(Term(graph, a[0]));
  return log(Term(graph, a[1])) - log_low;
}

/// log of the density of x whose logarithm is uniform; `log_uniform(lower, upper)` in a model. Not the same as a prior uniform in
/// x, nor as one on "log values" of another base: every base gives this density.
///
///   log p = -log x - log(log upper - log lower),   0 < lower < x < upper                                   Jeffreys 1961, sec. 3.1
///
/// x, lower, upper: unit u.
NodeId log_uniform_log_density(Graph& graph, NodeId x, Nodes a) {
  Term const constant = log(log_width(graph, a));
  return (-log(Term(graph, x)) - constant).id;
}
/// Shares of log(upper / lower) below and above x, exact near the ends: log(x/a) = log1p((x - a)/a).
NodeId log_uniform_cumulative(Graph& graph, NodeId x, Nodes a) {
  Term const low(graph, a[0]);
  Term const width = log_width(graph, a);
  return (log1p((Term(graph, x) - low) / low) / width).id;
}
NodeId log_uniform_survival(Graph& graph, NodeId x, Nodes a) {
  Term const value(graph, x);
  Term const width = log_width(graph, a);
  return (log1p((Term(graph, a[1]) - value) / value) / width).id;
}
double log_uniform_quantile(double probability, Tail tail, Numbers a) {
  double const distance = (elementary::log(a[1]) - elementary::log(a[0])) * probability;
  return std::clamp(tail == Tail::lower ? a[0] * elementary::exp(distance) : a[1] * elementary::exp(-distance), a[0], a[1]);
}
double log_uniform_draw(Stream& stream, Numbers a) { return log_uniform_quantile(stream.uniform(), Tail::lower, a); }
void log_uniform_widen(double factor, std::span<double> a) {
  double const low = elementary::log(a[0]), half = 0.5 * (elementary::log(a[1]) - low), middle = low + half;
  a[0] = elementary::exp(middle - factor * half);
  a[1] = elementary::exp(middle + factor * half);
}
std::string_view log_uniform_refuse(Numbers a) {
  if (!positive(a[0]) || !positive(a[1])) return "both bounds must be positive";
  if (!(a[0] < a[1])) return "lower must be below upper";
  return {};
}

}  // namespace uniform_parts

DistributionRow uniform_distribution() {
  using namespace uniform_parts;
  return {.name = "uniform",
          .arguments = arguments,
          .log_density = &uniform_log_density,
          .cumulative = &uniform_cumulative,
          .survival = &uniform_survival,
          .lower = &lower_bound,
          .upper = &upper_bound,
          .draw = &uniform_draw,
          .quantile = &uniform_quantile,
          .widen = &uniform_widen,
          .refuse = &uniform_refuse,
          .summary = "uniform between two bounds"};
}

DistributionRow log_uniform_distribution() {
  using namespace uniform_parts;
  return {.name = "log_uniform",
          .arguments = arguments,
          .logarithmic = true,
          .log_density = &log_uniform_log_density,
          .cumulative = &log_uniform_cumulative,
          .survival = &log_uniform_survival,
          .lower = &lower_bound,
          .upper = &upper_bound,
          .draw = &log_uniform_draw,
          .quantile = &log_uniform_quantile,
          .widen = &log_uniform_widen,
          .refuse = &log_uniform_refuse,
          .summary = "uniform in the logarithm, between two positive bounds"};
}

}  // namespace sysid
