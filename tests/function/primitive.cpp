// Special functions against closed forms and R.
#include "function/primitive.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>

#include "relative.hpp"

using namespace sysid;

namespace {

double constant_of(Graph const& graph, Term term) { return graph.constant_value(term.id).value(); }

double beta_value(double a, double b, double x) {
  Graph graph;
  return constant_of(graph, incomplete_beta(Term(graph, a), Term(graph, b), Term(graph, x)).lower);
}

}  // namespace

TEST_CASE("digamma has its closed-form values, its recurrence and its poles") {
  constexpr double euler = std::numbers::egamma;
  CHECK(digamma(1) == doctest::Approx(-euler).epsilon(1e-15));                            // DLMF 5.4.12
  CHECK(digamma(0.5) == doctest::Approx(-euler - 2 * std::numbers::ln2).epsilon(1e-15));  // DLMF 5.4.13
  CHECK(digamma(0.25) == doctest::Approx(-euler - std::numbers::pi / 2 - 3 * std::numbers::ln2).epsilon(1e-15));
  CHECK(digamma(-0.5) == relative(0.036489973978576520559, 1e-14));  // 2 + digamma(0.5)
  CHECK(digamma(1e10) == doctest::Approx(std::log(1e10)).epsilon(1e-11));
  for (double x = 0.1; x < 30; x += 0.7) CHECK(digamma(x + 1) - digamma(x) == relative(1 / x, 1e-13));
  CHECK(std::isnan(digamma(0)));
  CHECK(std::isnan(digamma(-3)));
}

TEST_CASE("the incomplete gamma functions have their closed forms for whole shapes and tails as R gives them") {
  auto const p = gamma_p_function.binary, q = gamma_q_function.binary;
  for (double x = 0.01; x < 40; x *= 1.7) {
    CHECK(p(1, x) == relative(-std::expm1(-x), 1e-14));
    CHECK(q(3, x) == relative(std::exp(-x) * (1 + x + x * x / 2), 1e-13));
  }
  // R: pgamma(120, 2.5, lower.tail = FALSE)
  CHECK(q(2.5, 120) == relative(7.6774168329755527e-50, 1e-13));
  double const infinity = std::numeric_limits<double>::infinity();
  CHECK(p(2, infinity) == 1);
  CHECK(q(2, infinity) == 0);
  CHECK(p(2, 0) == 0);
  CHECK(std::isnan(p(-1, 2)));
  CHECK(std::isnan(p(2, -1)));
}

TEST_CASE("Student's t has its closed forms for one and two degrees of freedom") {
  auto const cdf = student_t_cdf_function.binary;
  for (double t = -30; t < 30; t += 0.9) {
    // As printed, 1/2 + atan(t)/pi and 1/2 + t/(2 sqrt(2 + t^2)), but without a difference in the lower tail.
    CHECK(cdf(t, 1) == relative(std::atan2(1, -t) / std::numbers::pi, 1e-13));
    double const root = std::sqrt(2 + t * t), tail = 1 / (root * (root + std::abs(t)));
    CHECK(cdf(t, 2) == relative(t < 0 ? tail : 1 - tail, 1e-13));
  }
  // R: pt(-40, 3.5)
  CHECK(cdf(-40, 3.5) == relative(4.3832205546865114e-06, 1e-13));
  CHECK(cdf(-std::numeric_limits<double>::infinity(), 3) == 0);
  CHECK(cdf(std::numeric_limits<double>::infinity(), 3) == 1);
  CHECK(std::isnan(cdf(1, -1)));
}

TEST_CASE("derivatives of the incomplete gamma functions and Student's t match differences of higher order") {
  // Fourth-order differences over h = 1e-3: error of order 1e-11.
  constexpr double h = 1e-3;
  for (Function const* function : {&gamma_p_function, &gamma_q_function, &student_t_cdf_function}) {
    Graph graph;
    NodeId const a = graph.leaf(LeafKind::parameter, 0), b = graph.leaf(LeafKind::parameter, 1);
    NodeId const value = graph.call(*function, a, b);
    for (int which = 0; which < 2; ++which) {
      NodeId const derivative = graph.differentiate(value, which == 0 ? a : b);
      auto const at = [&](double by) { return which == 0 ? function->binary(1.7 + by, 2.9) : function->binary(1.7, 2.9 + by); };
      double const expected = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
      CAPTURE(function->name);
      CHECK(graph.evaluate(derivative, [&](NodeId id) { return id == a ? 1.7 : 2.9; }) == relative(expected, 1e-8));
    }
  }
}

TEST_CASE("the incomplete beta function has its closed forms and the values of R") {
  for (double x = 0.02; x < 1; x += 0.07) {
    CHECK(beta_value(1, 3, x) == relative(1 - std::pow(1 - x, 3), 1e-13));
    CHECK(beta_value(4, 1, x) == relative(std::pow(x, 4), 1e-13));
    CHECK(beta_value(0.5, 0.5, x) == relative(2 / std::numbers::pi * std::asin(std::sqrt(x)), 1e-13));
  }
  Graph graph;
  // 1 - I_x(1, b) = (1 - x)^b, far below what 1 - I_x would keep.
  Term const upper = incomplete_beta(Term(graph, 1.0), Term(graph, 9.0), Term(graph, 0.99)).upper;
  CHECK(constant_of(graph, upper) == relative(1e-18, 1e-12));
  CHECK(beta_value(2, 3, 0) == 0);
  CHECK(beta_value(2, 3, 1) == 1);
  // R: pbeta(0.3, 0.2, 7); pbeta(0.45, 300, 400); pbeta(1e-3, 5, 0.5); pbeta(0.52, 1000, 900)
  CHECK(beta_value(0.2, 7, 0.3) == doctest::Approx(0.99182245801738134).epsilon(1e-12));
  CHECK(beta_value(300, 400, 0.45) == doctest::Approx(0.87382502867342637).epsilon(1e-11));
  CHECK(beta_value(5, 0.5, 1e-3) == relative(2.4619635502857230e-16, 1e-12));
  CHECK(beta_value(1000, 900, 0.52) == relative(0.29051780401101973, 1e-11));
}
