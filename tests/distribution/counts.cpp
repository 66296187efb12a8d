// Distributions of counts: probabilities that sum to one with the stated moments, numbers from R 4.2, draws against the
// probabilities.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "cases.hpp"
#include "distribution/counts.hpp"
#include "relative.hpp"

using namespace sysid;
using test::Case;

namespace {

/// log p of one case as a function of the count.
struct Counting {
  Case given;
  Graph graph;
  NodeId count = graph.leaf(LeafKind::measured);
  NodeId density = 0, saturated = 0;

  explicit Counting(Case const& of) : given(of) {
    Distribution const use = given.in(graph);
    density = log_density(graph, use, count);
    saturated = use.row->saturated(graph, count, use.arguments);
  }
  double at(NodeId node, double y) const {
    return graph.evaluate(node, [&](NodeId) { return y; });
  }
  double log_probability(double y) const { return at(density, y); }
  double probability(double y) const { return std::exp(log_probability(y)); }
};

double log_probability(Case const& given, double y) { return Counting(given).log_probability(y); }

}  // namespace

TEST_CASE("every distribution of counts sums to one with the mean, variance and kurtosis it states") {
  // Summed until what is left is below 1e-14 of the largest term.
  for (Case const& given : test::count_cases()) {
    Counting const p(given);
    DistributionRow const& row = given.row();
    Graph graph;
    double const mean = *graph.constant_value(row.centre(graph, given.in(graph).arguments)),
                 variance = row.variance(given.arguments);
    double const end = mean + 60 * std::sqrt(variance) + 200 * (1 + variance / (1 + mean));
    double sum = 0, first = 0, second = 0, fourth = 0;
    for (double y = 0; y < end; y += 1) {
      double const share = p.probability(y), away = y - mean;
      sum += share;
      first += share * y;
      second += share * away * away;
      fourth += share * away * away * away * away;
    }
    CAPTURE(describe(given));
    CHECK(sum == doctest::Approx(1).epsilon(1e-11));
    CHECK(first == doctest::Approx(mean).epsilon(1e-11));
    CHECK(second == doctest::Approx(variance).epsilon(1e-10));
    if (mean > 0) CHECK(fourth / (second * second) - 3 == relative(row.excess_kurtosis(given.arguments), 1e-8));
  }
}

TEST_CASE("probabilities of counts are those of R") {
  auto const about = [](double value) { return doctest::Approx(value).epsilon(2e-14); };
  // R: dpois(c(0, 7), 2.5, log = TRUE); dpois(120, 100, log = TRUE)
  CHECK(log_probability({"poisson", {2.5}}, 0) == about(-2.5));
  CHECK(log_probability({"poisson", {2.5}}, 7) == about(-4.6111262379463289));
  CHECK(log_probability({"poisson", {100}}, 120) == about(-5.1919656627072168));
  // R: dnbinom(0, size = 3, mu = 2, log = TRUE); dnbinom(7, size = 0.4, mu = 5, ...); dnbinom(7, size = 250, mu = 5, ...)
  CHECK(log_probability({"negative_binomial", {2, 3}}, 0) == about(-1.5324768712979722));
  CHECK(log_probability({"negative_binomial", {5, 0.4}}, 7) == about(-3.5612373646129241));
  CHECK(log_probability({"negative_binomial", {5, 250}}, 7) == about(-2.2650899242911233));
}

TEST_CASE("a mean of zero gives a count of zero for certain, a negative one no probability at all") {
  for (Case const& given : {Case{"poisson", {0}}, Case{"negative_binomial", {0, 3}}}) {
    CHECK(log_probability(given, 0) == 0);
    CHECK(log_probability(given, 1) == -std::numeric_limits<double>::infinity());
    Stream stream(StreamKey{.seed = 1});
    for (int i = 0; i < 20; ++i) CHECK(given.row().draw(stream, given.arguments) == 0);
  }
  CHECK(std::isnan(log_probability({"poisson", {-1e-9}}, 0)));
  CHECK(std::isnan(log_probability({"negative_binomial", {-1e-9, 3}}, 0)));
}

TEST_CASE("shape and overdispersion are one argument, and a large shape is Poisson's limit") {
  Graph graph;
  ArgumentRow const& row = find_distribution("negative_binomial")->arguments[1];
  CHECK(*graph.constant_value(row.spellings[1].to_canonical(graph, graph.constant(0.25), {})) == 4);
  // The first correction is ((y - mean)^2 - y)/(2 shape).
  CHECK(log_probability({"negative_binomial", {5, 1e8}}, 7) ==
        doctest::Approx(log_probability({"poisson", {5}}, 7) + (4 - 7) / 2e8).epsilon(1e-13));
  // The next correction, of order (y/shape)^2 y, is 2e-12 here; the terms that cancel are of size 500.
  CHECK(log_probability({"negative_binomial", {100, 1e9}}, 120) ==
        doctest::Approx(log_probability({"poisson", {100}}, 120) + (400 - 120) / 2e9).epsilon(1e-12));
  // Both forms of log Gamma(r + y) - log Gamma(r) - y log r meet at r = 20.
  double const below = log_probability({"negative_binomial", {9, std::nextafter(20.0, 0.0)}}, 13);
  CHECK(log_probability({"negative_binomial", {9, 20}}, 13) == doctest::Approx(below).epsilon(1e-13));
}

TEST_CASE("no mean makes a count likelier than its own value") {
  for (Case const& given : test::count_cases()) {
    Counting const p(given);
    CAPTURE(describe(given));
    for (double const y : {0.0, 1.0, 2.0, 9.0, 40.0}) {
      std::vector<double> arguments = given.arguments;
      arguments[0] = y;
      CHECK(p.at(p.saturated, y) == log_probability({given.name, arguments}, y));
      CHECK(p.at(p.saturated, y) >= p.log_probability(y));
    }
  }
}

TEST_CASE("draws of counts follow their probabilities") {
  // Pearson's statistic over the counts that are expected at least 10 times, the rest of each tail in one class: chi-squared with
  // at most 60 degrees of freedom, whose 1e-6 quantile is below 130.
  constexpr int n = 20'000;
  for (Case const& given : test::count_cases()) {
    Counting const p(given);
    Stream stream(StreamKey{.seed = 5}), again(StreamKey{.seed = 5});
    std::vector<int> seen(4000);
    bool whole = true, same = true;
    for (int i = 0; i < n; ++i) {
      double const y = given.row().draw(stream, given.arguments);
      same = same && y == given.row().draw(again, given.arguments);
      whole = whole && y >= 0 && y == std::floor(y);
      ++seen[static_cast<std::size_t>(std::min(y, 3999.0))];
    }
    double statistic = 0, expected = 0, found = 0;
    int classes = 0;
    for (std::size_t y = 0; y < seen.size(); ++y) {
      expected += n * p.probability(static_cast<double>(y));
      found += seen[y];
      // Wide distributions are lumped so that there are at most 60 classes.
      if (expected < std::max(10.0, n / 55.0)) continue;
      statistic += (found - expected) * (found - expected) / expected;
      expected = found = 0;
      ++classes;
    }
    double const rest = std::max(expected, 10.0);
    statistic += (found - expected) * (found - expected) / rest;
    CAPTURE(describe(given));
    CHECK(whole);
    CHECK(same);
    CHECK(classes <= 60);
    CHECK(statistic < 130);
  }
}
