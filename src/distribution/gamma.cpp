// The gamma distribution and the inverse gamma distribution, that of 1/x.
#include <boost/math/special_functions/gamma.hpp>

#include <algorithm>

#include "core/numeric/elementary.hpp"
#include "distribution/rows.hpp"
#include "function/boost_policy.hpp"

namespace sysid {
namespace gamma_parts {

NodeId scale_from_rate(Graph& graph, NodeId rate, Nodes) { return (1.0 / Term(graph, rate)).id; }
NodeId scale_from_mean(Graph& graph, NodeId mean, Nodes before) { return (Term(graph, mean) / Term(graph, before[0])).id; }

constexpr Spelling shape[] = {{"shape", 0, nullptr}};
constexpr Spelling scale[] = {{"scale", 1, nullptr}, {"rate", -1, &scale_from_rate}, {"mean", 1, &scale_from_mean}};
constexpr Spelling only_scale[] = {{"scale", 1, nullptr}};
constexpr ArgumentRow gamma_arguments[] = {{shape, must_be_given}, {scale, must_be_given}};
constexpr ArgumentRow inverse_arguments[] = {{shape, must_be_given}, {only_scale, must_be_given}};

/// Variates stay normal positive numbers: a shape far below 1 has most of its mass under the smallest double.
double within_doubles(double x) { return std::clamp(x, std::numeric_limits<double>::min(), std::numeric_limits<double>::max()); }

/// By Boost's inverse of the incomplete gamma function, exempt from equality across processors.
double standard_quantile(double shape, double probability, Tail tail) {
  return tail == Tail::lower ? boost::math::gamma_p_inv(shape, probability, BoostPolicy())
                             : boost::math::gamma_q_inv(shape, probability, BoostPolicy());
}

/// Mean and sd of the gamma distribution: shape scale and scale sqrt(shape); those of 1/x for the inverse.
void gamma_widen(double factor, std::span<double> a) {
  a[0] /= factor * factor;
  a[1] *= factor * factor;
}
void inverse_widen(double factor, std::span<double> a) {
  a[0] /= factor * factor;
  a[1] /= factor * factor;
}

std::string_view refuse(Numbers a) {
  if (!positive(a[0])) return "the shape must be positive";
  if (!positive(a[1])) return "scale, rate or mean must be positive";
  return {};
}

/// log of the gamma density; `gamma(shape, scale | rate | mean = ...)` in a model.
///
///   log p = (shape - 1) log x - x/scale - log Gamma(shape) - shape log scale,   x > 0                      Gelman et al. 2013,
///   app. A
///
/// x, scale, mean = shape*scale: unit u; rate = 1/scale: u^-1; shape: a pure number; all > 0.
NodeId gamma_log_density(Graph& graph, NodeId x, Nodes a) {
  Term const value(graph, x), k(graph, a[0]), s(graph, a[1]);
  Term const of_scale = k * log(s), of_shape = lgamma(k), ratio = value / s, log_value = log(value);
  return ((k - 1.0) * log_value - ratio - of_shape - of_scale).id;
}
NodeId gamma_cumulative(Graph& graph, NodeId x, Nodes a) {
  return gamma_p(Term(graph, a[0]), Term(graph, x) / Term(graph, a[1])).id;
}
NodeId gamma_survival(Graph& graph, NodeId x, Nodes a) { return gamma_q(Term(graph, a[0]), Term(graph, x) / Term(graph, a[1])).id; }
double gamma_draw(Stream& stream, Numbers a) { return within_doubles(a[1] * elementary::exp(log_standard_gamma(a[0], stream))); }
double gamma_quantile(double probability, Tail tail, Numbers a) { return a[1] * standard_quantile(a[0], probability, tail); }

/// log of the inverse gamma density; `inverse_gamma(shape, scale)` in a model.
///
///   log p = shape log scale - log Gamma(shape) - (shape + 1) log x - scale/x,   x > 0                      Gelman et al. 2013,
///   app. A
///
/// x, scale: unit u; shape: a pure number; both > 0.
NodeId inverse_log_density(Graph& graph, NodeId x, Nodes a) {
  Term const value(graph, x), k(graph, a[0]), s(graph, a[1]);
  Term const ratio = s / value, log_value = log(value), power = (k + 1.0) * log_value, of_shape = lgamma(k);
  return (k * log(s) - of_shape - power - ratio).id;
}
NodeId inverse_cumulative(Graph& graph, NodeId x, Nodes a) {
  return gamma_q(Term(graph, a[0]), Term(graph, a[1]) / Term(graph, x)).id;
}
NodeId inverse_survival(Graph& graph, NodeId x, Nodes a) {
  return gamma_p(Term(graph, a[0]), Term(graph, a[1]) / Term(graph, x)).id;
}
double inverse_draw(Stream& stream, Numbers a) { return within_doubles(a[1] * elementary::exp(-log_standard_gamma(a[0], stream))); }
double inverse_quantile(double probability, Tail tail, Numbers a) {
  return a[1] / standard_quantile(a[0], probability, tail == Tail::lower ? Tail::upper : Tail::lower);
}

}  // namespace gamma_parts

DistributionRow gamma_distribution() {
  using namespace gamma_parts;
  return {.name = "gamma",
          .arguments = gamma_arguments,
          .log_density = &gamma_log_density,
          .cumulative = &gamma_cumulative,
          .survival = &gamma_survival,
          .lower = &zero_bound,
          .draw = &gamma_draw,
          .quantile = &gamma_quantile,
          .widen = &gamma_widen,
          .refuse = &refuse,
          .summary = "gamma, by its shape and one of scale, rate and mean"};
}

DistributionRow inverse_gamma_distribution() {
  using namespace gamma_parts;
  return {.name = "inverse_gamma",
          .arguments = inverse_arguments,
          .log_density = &inverse_log_density,
          .cumulative = &inverse_cumulative,
          .survival = &inverse_survival,
          .lower = &zero_bound,
          .draw = &inverse_draw,
          .quantile = &inverse_quantile,
          .widen = &inverse_widen,
          .refuse = &refuse,
          .summary = "inverse gamma, for variances: 1/x is gamma-distributed"};
}

}  // namespace sysid
