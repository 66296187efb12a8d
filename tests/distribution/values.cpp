// Log densities, distribution functions and spellings against numbers from R 4.2 and closed forms; truncation in the tails.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "cases.hpp"
#include "core/text/diagnostic.hpp"
#include "distribution/rows.hpp"
#include "relative.hpp"

using namespace sysid;
using test::Case;

namespace {

double log_density_at(Case const& given, double x) {
  Graph graph;
  Distribution const use = given.in(graph);
  return *graph.constant_value(log_density(graph, use, graph.constant(x)));
}

double cumulative_at(Case const& given, double x) {
  Graph graph;
  Distribution const use = given.in(graph);
  return *graph.constant_value(use.row->cumulative(graph, graph.constant(x), use.arguments));
}

/// The canonical value of argument `index` given as `spelling`.
double canonical(std::string_view distribution, std::size_t index, std::string_view spelling, double value,
                 std::vector<double> const& before) {
  Graph graph;
  std::vector<NodeId> nodes;
  for (double const each : before) nodes.push_back(graph.constant(each));
  for (Spelling const& each : find_distribution(distribution)->arguments[index].spellings)
    if (each.name == spelling)
      return each.to_canonical == nullptr ? value : *graph.constant_value(each.to_canonical(graph, graph.constant(value), nodes));
  FAIL("no such spelling");
  return 0;
}

doctest::Approx about(double value) { return relative(value, 4e-15); }

}  // namespace

TEST_CASE("log densities are those of R") {
  // R: dnorm(1.3, 0.3, 0.5, log = TRUE)
  CHECK(log_density_at({"normal", {0.3, 0.5}}, 1.3) == about(-2.2257913526447273));
  // R: dlnorm(3, log(2), 0.25, log = TRUE)
  CHECK(log_density_at({"log_normal", {2, 0.25}}, 3) == about(-1.9464720918982161));
  // R: log(2) + dnorm(2, 0, 1.7, log = TRUE)
  CHECK(log_density_at({"half_normal", {1.7}}, 2) == about(-1.4484611261982474));
  // R: dt(1.5/0.6, 4, log = TRUE) - log(0.6); dt(1.2, 1e6, log = TRUE); dt(30, 3.5, log = TRUE)
  CHECK(log_density_at({"student_t", {1, 4, 0.6}}, 2.5) == about(-2.822461990407052));
  CHECK(log_density_at({"student_t", {0, 1e6, 1}}, 1.2) == about(-1.6389389848046521));
  CHECK(log_density_at({"student_t", {0, 3.5, 1}}, 30) == about(-13.48487815971756));
  // R: log(2) + dcauchy(4, 0, 2.5, log = TRUE)
  CHECK(log_density_at({"half_cauchy", {2.5}}, 4) == about(-2.6376339820275492));
  // R: dexp(1.1, 1/0.4, log = TRUE)
  CHECK(log_density_at({"exponential", {0.4}}, 1.1) == about(-1.8337092681258449));
  // R: dgamma(1.7, 7.5, scale = 0.3, log = TRUE)
  CHECK(log_density_at({"gamma", {7.5, 0.3}}, 1.7) == about(-0.72215123907677237));
  // R: dgamma(1/0.9, 3, rate = 2, log = TRUE) - 2*log(0.9)
  CHECK(log_density_at({"inverse_gamma", {3, 2}}, 0.9) == about(-0.4144857984710264));
  // R: dbeta(0.37, 40, 25, log = TRUE), whose lgamma terms reach 200: eps times that; dbeta(0.1, 0.5, 1.5, log = TRUE)
  CHECK(log_density_at({"beta", {40, 25}}, 0.37) == doctest::Approx(-6.1129798668428004).epsilon(2e-14));
  CHECK(log_density_at({"beta", {0.5, 1.5}}, 0.1) == about(0.64702958337865457));
  CHECK(log_density_at({"uniform", {-2, 5}}, 1) == about(-std::log(7)));
  CHECK(log_density_at({"log_uniform", {1, 100}}, 10) == about(-std::log(10) - std::log(2 * std::numbers::ln10)));
  CHECK(log_density_at({"flat", {}}, 1e9) == 0);
  CHECK(log_density_at({"flat", {}, 0, 2}, 1) == 0);
  CHECK(log_density_at({"log_flat", {}}, 4) == about(-std::log(4)));
  CHECK(log_density_at({"log_flat", {}, 1, 8}, 4) == about(-std::log(4)));
}

TEST_CASE("distribution functions are those of R") {
  // R: plnorm(3, log(2), 0.25); 2*pnorm(2, 0, 1.7) - 1; 2*pcauchy(4, 0, 2.5) - 1
  CHECK(cumulative_at({"log_normal", {2, 0.25}}, 3) == about(0.94758338235719841));
  CHECK(cumulative_at({"half_normal", {1.7}}, 2) == about(0.76059312120321065));
  CHECK(cumulative_at({"half_cauchy", {2.5}}, 4) == about(0.6443846310212944));
  // R: pgamma(1.7, 7.5, scale = 0.3); pgamma(1/0.9, 3, rate = 2, lower.tail = FALSE); pbeta(0.37, 40, 25)
  CHECK(cumulative_at({"gamma", {7.5, 0.3}}, 1.7) == about(0.2713730857584748));
  CHECK(cumulative_at({"inverse_gamma", {3, 2}}, 0.9) == about(0.61676121858387656));
  CHECK(cumulative_at({"beta", {40, 25}}, 0.37) == relative(3.0720047284627843e-05, 1e-13));
  // R: pnorm(-20)
  CHECK(cumulative_at({"normal", {0, 1}}, -20) == relative(2.7536241186062337e-89, 1e-13));
}

TEST_CASE("the normal quantile is that of R from one tail to the other") {
  // R: qnorm(c(1e-300, 1e-20, 0.001, 0.3))
  CHECK(standard_normal_quantile(1e-300) == about(-37.047096299361201));
  CHECK(standard_normal_quantile(1e-20) == about(-9.2623400897984052));
  CHECK(standard_normal_quantile(0.001) == about(-3.0902323061678132));
  CHECK(standard_normal_quantile(0.3) == about(-0.52440051270804067));
  CHECK(standard_normal_quantile(0.5) == 0);
  CHECK(standard_normal_quantile(0.999) == doctest::Approx(3.0902323061678132).epsilon(1e-13));
}

TEST_CASE("a truncated density keeps its digits in the far tail") {
  // R: dnorm(6.2, log = TRUE) - log(pnorm(6, lower.tail = FALSE) - pnorm(7, lower.tail = FALSE))
  CHECK(log_density_at({"normal", {0, 1}, 6, 7}, 6.2) == doctest::Approx(0.59912847007779391).epsilon(1e-13));
  // An exponential has no memory: cut off below at 30 means it is the same density, moved there.
  CHECK(log_density_at({"exponential", {1}, 30}, 31) == doctest::Approx(-1).epsilon(1e-14));
  CHECK(log_density_at({"uniform", {-2, 5}, 0, 9}, 1) == about(-std::log(5)));
}

TEST_CASE("an interval without mass has density zero and no draws") {
  CHECK(log_density_at({"uniform", {0, 1}, 2, 3}, 2.5) == -infinity);
  Stream stream{StreamKey{}};
  std::vector<double> const unit = {0, 1};
  auto const code = [&](DistributionRow const& row, std::vector<double> const& arguments, double lower, double upper) {
    try {
      draw(row, arguments, lower, upper, stream);
    } catch (UserError const& error) {
      return error.diagnostic().code;
    }
    return std::string();
  };
  CHECK(code(*find_distribution("uniform"), unit, 2, 3) == "E2115");
  CHECK(code(*find_distribution("normal"), unit, 60, 61) == "E2115");
  CHECK(code(*find_distribution("normal"), unit, 1, -1) == "E2115");
  CHECK(code(*find_distribution("flat"), {}, 0, 1) == "E2114");
  CHECK(code(*find_distribution("log_flat"), {}, 0, 1) == "E2114");
  CHECK(code(*find_distribution("normal"), {0, -1}, 0, 1) == "E2112");
  CHECK(code(*find_distribution("normal"), unit, 0, 1) == "");
}

TEST_CASE("sd, variance and precision are one argument in three spellings") {
  for (std::string_view const name : {"normal", "log_normal"}) {
    CHECK(canonical(name, 1, "sd", 0.5, {1}) == 0.5);
    CHECK(canonical(name, 1, "variance", 0.25, {1}) == 0.5);
    CHECK(canonical(name, 1, "precision", 4, {1}) == 0.5);
  }
  CHECK(canonical("exponential", 0, "rate", 4, {}) == 0.25);
  CHECK(canonical("gamma", 1, "rate", 4, {3}) == 0.25);
  CHECK(canonical("gamma", 1, "mean", 6, {3}) == 2);
}

TEST_CASE("the sd of Student's t is that of its variate, so it needs more than two degrees of freedom") {
  // Variance = scale^2 n/(n-2): n = 4 and scale 1 give 2.
  CHECK(canonical("student_t", 2, "variance", 2, {0, 4}) == about(1));
  CHECK(canonical("student_t", 2, "sd", std::sqrt(2), {0, 4}) == about(1));
  CHECK(canonical("student_t", 2, "precision", 0.5, {0, 4}) == about(1));
  double const scale = canonical("student_t", 2, "sd", 1, {0, 1.5});
  CHECK(find_distribution("student_t")->refuse(std::vector<double>{0, 1.5, scale}).find("above 2") != std::string_view::npos);
}

TEST_CASE("each argument's spellings are its own, so that a name means one thing") {
  for (DistributionRow const& row : distributions()) {
    std::set<std::string_view> names;
    for (ArgumentRow const& argument : row.arguments) {
      CHECK((argument.spellings.front().to_canonical == nullptr));
      for (Spelling const& spelling : argument.spellings) CHECK(names.insert(spelling.name).second);
    }
  }
}

TEST_CASE("a bound that is a parameter cuts off like a number") {
  Graph graph;
  NodeId const bound = graph.leaf(LeafKind::parameter, 0);
  Distribution use;
  use.row = find_distribution("half_normal");
  use.arguments = {graph.constant(1)};
  use.upper = bound;
  NodeId const density = log_density(graph, use, graph.constant(0.2));
  CHECK(graph.evaluate(density, [](NodeId) { return 0.3; }) == log_density_at({"half_normal", {1}, -infinity, 0.3}, 0.2));
  Support const bounds = support(graph, use);
  CHECK(bounds.lower == graph.constant(0));
  CHECK(bounds.upper == bound);
}

TEST_CASE("a lower bound of -0 cuts nothing off what begins at 0") {
  for (Case const& each : {Case{"half_cauchy", {1}}, Case{"half_normal", {1}}}) {
    Graph graph;
    Distribution use = each.in(graph);
    NodeId const whole = log_density(graph, use, graph.constant(0.5));
    use.lower = graph.constant(-0.0);
    CHECK(mass(graph, use) == graph.constant(1));
    CHECK(log_density(graph, use, graph.constant(0.5)) == whole);
  }
}

TEST_CASE("infinite bounds are none") {
  Graph graph;
  Distribution use = Case{"normal", {0, 1}}.in(graph);
  use.lower = graph.constant(-infinity);
  use.upper = graph.constant(infinity);
  CHECK_FALSE(support(graph, use).lower.has_value());
  CHECK_FALSE(support(graph, use).upper.has_value());
  CHECK(mass(graph, use) == graph.constant(1));
}
