// The exponential distribution.
#include "core/numeric/elementary.hpp"
#include "distribution/rows.hpp"

namespace sysid {
namespace exponential_parts {

NodeId mean_from_rate(Graph& graph, NodeId rate, Nodes) { return (1.0 / Term(graph, rate)).id; }

constexpr Spelling mean[] = {{"mean", 1, nullptr}, {"rate", -1, &mean_from_rate}};
constexpr ArgumentRow arguments[] = {{mean, must_be_given}};

/// log of the exponential density; `exponential(mean | rate = ...)` in a model.
///
///   log p = -log mean - x/mean,   x >= 0,   rate = 1/mean                                                  Gelman et al. 2013,
///   app. A
///
/// x, mean: unit u; rate: u^-1; mean > 0.
NodeId log_density(Graph& graph, NodeId x, Nodes a) {
  Term const m(graph, a[0]);
  Term const ratio = Term(graph, x) / m, constant = -log(m);
  return (constant - ratio).id;
}

NodeId cumulative(Graph& graph, NodeId x, Nodes a) { return (-expm1(-(Term(graph, x) / Term(graph, a[0])))).id; }
NodeId survival(Graph& graph, NodeId x, Nodes a) { return exp(-(Term(graph, x) / Term(graph, a[0]))).id; }

double quantile(double probability, Tail tail, Numbers a) {
  return -a[0] * (tail == Tail::lower ? elementary::log1p(-probability) : elementary::log(probability));
}
double draw(Stream& stream, Numbers a) { return quantile(stream.uniform(), Tail::upper, a); }

std::string_view refuse(Numbers a) { return positive(a[0]) ? std::string_view() : "mean or rate must be positive"; }

}  // namespace exponential_parts

DistributionRow exponential_distribution() {
  using namespace exponential_parts;
  return {.name = "exponential",
          .arguments = arguments,
          .log_density = &log_density,
          .cumulative = &cumulative,
          .survival = &survival,
          .lower = &zero_bound,
          .draw = &draw,
          .quantile = &quantile,
          .widen = &widen_argument<0>,
          .refuse = &refuse,
          .summary = "exponential, by mean or rate"};
}

}  // namespace sysid
