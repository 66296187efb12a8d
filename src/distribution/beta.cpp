// The beta distribution, for shares between 0 and 1.
#include <boost/math/special_functions/beta.hpp>

#include <algorithm>

#include "core/numeric/elementary.hpp"
#include "distribution/rows.hpp"
#include "function/boost_policy.hpp"

namespace sysid {
namespace beta_parts {

constexpr Spelling first[] = {{"a", 0, nullptr}};
constexpr Spelling second[] = {{"b", 0, nullptr}};
constexpr ArgumentRow arguments[] = {{first, must_be_given}, {second, must_be_given}};

NodeId upper(Graph& graph, Nodes) { return graph.constant(1); }

/// log of the beta density; `beta(a, b)` in a model.
///
///   log p = (a - 1) log x + (b - 1) log(1 - x) - log B(a, b),   0 < x < 1                                  Gelman et al. 2013,
///   app. A
///
/// x, a, b: pure numbers; a, b > 0.
NodeId log_density(Graph& graph, NodeId x, Nodes arguments) {
  Term const value(graph, x), a(graph, arguments[0]), b(graph, arguments[1]);
  Term const of_b = lgamma(b), of_a = lgamma(a), of_both = lgamma(a + b), log_rest = log1p(-value), upper = (b - 1.0) * log_rest,
             log_value = log(value), lower = (a - 1.0) * log_value;
  return (lower + upper + of_both - of_a - of_b).id;
}

NodeId cumulative(Graph& graph, NodeId x, Nodes a) {
  return incomplete_beta(Term(graph, a[0]), Term(graph, a[1]), Term(graph, x)).lower.id;
}
NodeId survival(Graph& graph, NodeId x, Nodes a) {
  return incomplete_beta(Term(graph, a[0]), Term(graph, a[1]), Term(graph, x)).upper.id;
}

/// G_a / (G_a + G_b) of two gamma variates, from their logarithms, which small a and b do not underflow.
double draw(Stream& stream, Numbers a) {
  double const log_a = log_standard_gamma(a[0], stream), log_b = log_standard_gamma(a[1], stream);
  double const x = 1 / (1 + elementary::exp(log_b - log_a));
  return std::clamp(x, std::numeric_limits<double>::min(), 1 - std::numeric_limits<double>::epsilon() / 2);
}

/// By Boost's inverse of the incomplete beta function, exempt from equality across processors.
double quantile(double probability, Tail tail, Numbers a) {
  return tail == Tail::lower ? boost::math::ibeta_inv(a[0], a[1], probability, BoostPolicy())
                             : boost::math::ibetac_inv(a[0], a[1], probability, BoostPolicy());
}

/// The mean m stays, and the variance m (1 - m)/(a + b + 1) is that many times as large; beyond m (1 - m) there is none, and the
/// arguments are not admissible.
void widen(double factor, std::span<double> a) {
  double const size = a[0] + a[1], ratio = ((size + 1) / (factor * factor) - 1) / size;
  a[0] *= ratio;
  a[1] *= ratio;
}

std::string_view refuse(Numbers a) { return positive(a[0]) && positive(a[1]) ? std::string_view() : "a and b must be positive"; }

}  // namespace beta_parts

DistributionRow beta_distribution() {
  using namespace beta_parts;
  return {.name = "beta",
          .arguments = arguments,
          .dimensionless = true,
          .log_density = &log_density,
          .cumulative = &cumulative,
          .survival = &survival,
          .lower = &zero_bound,
          .upper = &upper,
          .draw = &draw,
          .quantile = &quantile,
          .widen = &widen,
          .refuse = &refuse,
          .summary = "beta, for fractions between 0 and 1"};
}

}  // namespace sysid
