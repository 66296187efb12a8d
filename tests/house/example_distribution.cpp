// The worked example of a distribution in docs/extending.md, compiled and held to what the tests over the table ask of a row.
#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/elementary.hpp"
#include "distribution/rows.hpp"
#include "relative.hpp"

namespace sysid {
namespace logistic_parts {

/// variance = (pi scale)^2/3.
NodeId scale_from_sd(Graph& graph, NodeId sd, Nodes) { return (Term(graph, sd) * (std::numbers::sqrt3 / std::numbers::pi)).id; }

constexpr Spelling location[] = {{"location", 1, nullptr}};
constexpr Spelling scale[] = {{"scale", 1, nullptr}, {"sd", 1, &scale_from_sd}};
constexpr ArgumentRow arguments[] = {{location, must_be_given}, {scale, must_be_given}};

Term standardised(Graph& graph, NodeId x, Nodes a) { return (Term(graph, x) - Term(graph, a[0])) / Term(graph, a[1]); }

/// log density; `logistic(location, scale | sd = ...)` in a model.
///
///   log p = -|z| - log scale - 2 log(1 + e^-|z|),   z = (x - location)/scale        Johnson, Kotz, Balakrishnan 1995, eq. 23.10
///
/// x, location, scale, sd: unit u; scale > 0. Symmetric in z, so |z| stands for z and nothing overflows.
NodeId log_density(Graph& graph, NodeId x, Nodes a) {
  Term const z = abs(standardised(graph, x, a)), log_scale = log(Term(graph, a[1])), bend = 2.0 * log1p(exp(-z));
  return (-z - log_scale - bend).id;
}

NodeId cumulative(Graph& graph, NodeId x, Nodes a) { return (1.0 / (1.0 + exp(-standardised(graph, x, a)))).id; }
NodeId survival(Graph& graph, NodeId x, Nodes a) { return (1.0 / (1.0 + exp(standardised(graph, x, a)))).id; }
NodeId centre(Graph&, Nodes a) { return a[0]; }
NodeId saturated(Graph& graph, NodeId, Nodes a) { return (-log(4.0 * Term(graph, a[1]))).id; }

double quantile(double probability, Tail tail, Numbers a) {
  double const z = elementary::log(probability) - elementary::log1p(-probability);
  return a[0] + (tail == Tail::lower ? a[1] : -a[1]) * z;
}
double draw(Stream& stream, Numbers a) { return quantile(stream.uniform(), Tail::lower, a); }
NoiseMoments moments(Numbers a) { return {a[0], a[1] * a[1] * std::numbers::pi * std::numbers::pi / 3}; }

std::string_view refuse(Numbers a) { return positive(a[1]) ? std::string_view() : "scale or sd must be positive"; }

}  // namespace logistic_parts

DistributionRow logistic_distribution() {
  using namespace logistic_parts;
  return {.name = "logistic",
          .arguments = arguments,
          .noise = true,
          .log_density = &log_density,
          .cumulative = &cumulative,
          .survival = &survival,
          .centre = &centre,
          .saturated = &saturated,
          .draw = &draw,
          .quantile = &quantile,
          .refuse = &refuse,
          .summary = "bell-shaped, tails heavier than normal, by scale or sd",
          .moments = &moments};
}

}  // namespace sysid

using namespace sysid;

namespace {

using Member = NodeId (*)(Graph&, NodeId, std::span<NodeId const>);

double at(Member member, double x, double location, double scale) {
  Graph graph;
  NodeId const arguments[] = {graph.constant(location), graph.constant(scale)};
  return graph.constant_value(member(graph, graph.constant(x), std::span(arguments))).value();
}

}  // namespace

TEST_CASE("the example distribution has the integral 1, its tails, and draws from them") {
  DistributionRow const row = logistic_distribution();
  double sum = 0, h = 1e-3;
  for (double x = -30 + h / 2; x < 30; x += h) sum += h * std::exp(at(row.log_density, x, 0.3, 0.8));
  CHECK(sum == doctest::Approx(1).epsilon(1e-6));
  double const numbers[] = {0.3, 0.8};
  std::span<double const> const arguments(numbers);
  for (double const probability : {1e-12, 0.02, 0.5, 0.9}) {
    CHECK(at(row.cumulative, row.quantile(probability, Tail::lower, arguments), 0.3, 0.8) == relative(probability, 1e-12));
    CHECK(at(row.survival, row.quantile(probability, Tail::upper, arguments), 0.3, 0.8) == relative(probability, 1e-12));
  }
  Stream stream({.seed = 1, .purpose = Purpose::test, .index = 0, .step = 0});
  double distance = 0;
  int const count = 20000;
  for (int i = 0; i < count; ++i) distance += std::fabs(row.draw(stream, arguments) - 0.3) / count;
  // E |x - location| = 2 log(2) scale, and E (x - location)^2 = (pi scale)^2/3.
  double const mean = 2 * std::numbers::ln2 * 0.8, variance = std::pow(std::numbers::pi * 0.8, 2) / 3 - mean * mean;
  CHECK(std::fabs(distance - mean) < 4 * std::sqrt(variance / count));
  CHECK(row.moments(arguments).mean == 0.3);
  CHECK(row.moments(arguments).variance == doctest::Approx(std::pow(std::numbers::pi * 0.8, 2) / 3));
}
