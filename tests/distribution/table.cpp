// Checks over all distributions: what must hold for any of them holds for each. A new row is tested at birth.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "cases.hpp"
#include "core/text/diagnostic.hpp"
#include "relative.hpp"
#include "replications.hpp"

using namespace sysid;
using test::all_cases;
using test::Case;

namespace {

/// The log density and the sampler's coordinate of one case, as functions of a number.
struct Evaluated {
  Graph graph;
  NodeId leaf = graph.leaf(LeafKind::unconstrained);
  Distribution use;
  Support bounds;
  Coordinate coordinate{};
  NodeId density = 0;  // log p(x), x = leaf
  NodeId on_line = 0;  // log p(x(u)) + log |dx/du|, u = leaf

  explicit Evaluated(Case const& given) : use(given.in(graph)), bounds(support(graph, use)) {
    coordinate = constrain(graph, bounds, leaf);
    density = log_density(graph, use, leaf);
    below = use.row->cumulative(graph, leaf, use.arguments);
    beyond = use.row->survival(graph, leaf, use.arguments);
    on_line = graph.add(log_density(graph, use, coordinate.value), coordinate.log_jacobian);
  }
  NodeId below = 0, beyond = 0;  // P(X <= x), P(X > x), x = leaf
  double at(NodeId node, double value) const {
    return graph.evaluate(node, [&](NodeId) { return value; });
  }
  double cumulative(double x) const { return at(below, x); }
  double survival(double x) const { return at(beyond, x); }
  bool bounded() const { return bounds.lower || bounds.upper; }
};

}  // namespace

TEST_CASE("every distribution has a case here, a name of its own and a summary") {
  std::set<std::string_view> names;
  for (DistributionRow const& row : distributions()) {
    CAPTURE(row.name);
    CHECK(names.insert(row.name).second);
    CHECK(find_distribution(row.name) == &row);
    CHECK_FALSE(row.summary.empty());
    auto const covers = [&](Case const& use) { return use.name == row.name; };
    if (row.discrete) {
      CHECK(std::any_of(test::count_cases().begin(), test::count_cases().end(), covers));
      CHECK((row.draw != nullptr));
      CHECK((row.variance != nullptr));
      CHECK((row.excess_kurtosis != nullptr));
    } else if (row.proper) {
      CHECK(std::any_of(test::whole_cases().begin(), test::whole_cases().end(), covers));
      CHECK(std::any_of(test::truncated_cases().begin(), test::truncated_cases().end(), covers));
      CHECK((row.draw != nullptr));
      CHECK((row.quantile != nullptr));
      CHECK((row.survival != nullptr));
    }
    CHECK((row.centre != nullptr) == row.noise);
    CHECK((row.saturated != nullptr) == row.noise);
  }
  CHECK(find_distribution("gaussian") == nullptr);
}

TEST_CASE("every density integrates to one, whole and truncated") {
  // Trapezoidal rule in v with u = sinh v on the sampler's scale: the integrand is analytic and falls off exponentially, where the
  // rule converges geometrically; what lies beyond the ends is below 1e-11 (Student's t with 4 degrees of freedom: |x|^-4 at 1e7).
  constexpr double h = 1. / 256;
  for (Case const& given : all_cases()) {
    Evaluated const evaluated(given);
    double const end = evaluated.bounded() ? 7.2 : 17;
    double sum = 0;
    for (double v = -end; v <= end; v += h) sum += h * std::cosh(v) * std::exp(evaluated.at(evaluated.on_line, std::sinh(v)));
    CAPTURE(describe(given));
    CHECK(sum == doctest::Approx(1.0).epsilon(1e-9));
  }
}

TEST_CASE("the derivative of the distribution function is the density and of the survival function its negative") {
  // Fourth-order differences, h = 2e-4 of the interval between the quartiles: h^4 f^(5)/30 and eps/h are below 1e-9 of the density.
  for (Case const& given : test::whole_cases()) {
    Evaluated evaluated(given);
    double const width =
        given.row().quantile(0.25, Tail::upper, given.arguments) - given.row().quantile(0.25, Tail::lower, given.arguments);
    double const h = 2e-4 * width;
    for (double const p : {0.1, 0.3, 0.5, 0.8, 0.95}) {
      double const x = given.row().quantile(p, Tail::lower, given.arguments);
      auto const slope = [&](auto f) { return (8 * (f(x + h) - f(x - h)) - (f(x + 2 * h) - f(x - 2 * h))) / (12 * h); };
      double const density = std::exp(evaluated.at(evaluated.density, x));
      CAPTURE(describe(given));
      CAPTURE(p);
      CHECK(slope([&](double y) { return evaluated.cumulative(y); }) == relative(density, 1e-7));
      CHECK(-slope([&](double y) { return evaluated.survival(y); }) == relative(density, 1e-7));
    }
  }
}

TEST_CASE("distribution and survival function add to one, and the quantile inverts both in its own tail") {
  for (Case const& given : test::whole_cases()) {
    Evaluated evaluated(given);
    CAPTURE(describe(given));
    for (double const p : {1e-12, 1e-5, 0.02, 0.3, 0.5, 0.9}) {
      double const low = given.row().quantile(p, Tail::lower, given.arguments);
      double const high = given.row().quantile(p, Tail::upper, given.arguments);
      CAPTURE(p);
      CHECK(evaluated.cumulative(low) + evaluated.survival(low) == doctest::Approx(1).epsilon(1e-12));
      // x is rounded, which moves p by x f(x) eps: large against p where x is far from a bound's origin (normal(-40, 3): 13 eps/p
      // of it).
      double const spread = std::fabs(low) * std::exp(evaluated.at(evaluated.density, low)) / p;
      CHECK(std::fabs(evaluated.cumulative(low) / p - 1) < 1e-11 + 4e-16 * spread);
      double const other = std::fabs(high) * std::exp(evaluated.at(evaluated.density, high)) / p;
      CHECK(std::fabs(evaluated.survival(high) / p - 1) < 1e-11 + 4e-16 * other);
    }
  }
}

TEST_CASE("draws have the distribution, whole and truncated") {
  // Kolmogorov-Smirnov: P(D > sqrt(log(2/alpha)/(2 n))) <= alpha = 1e-6, Massart 1990.
  int const n = replications(4000, 10'000);
  double const threshold = std::sqrt(std::log(2 / 1e-6) / (2 * n));
  for (Case const& given : all_cases()) {
    Evaluated evaluated(given);
    Stream stream(StreamKey{.seed = 20240607, .purpose = Purpose::test});
    std::vector<double> draws(static_cast<std::size_t>(n));
    bool inside = true;
    for (double& x : draws) {
      x = draw(given.row(), given.arguments, given.lower, given.upper, stream);
      inside = inside && x >= given.lower && x <= given.upper && std::isfinite(x);
    }
    std::sort(draws.begin(), draws.end());
    // The truncated distribution function through the survival function where that keeps the digits.
    bool const tail = std::isfinite(given.lower) && evaluated.cumulative(given.lower) > 0.5;
    double const mass_inside = *evaluated.graph.constant_value(mass(evaluated.graph, evaluated.use));
    double const start = evaluated.bounds.lower
                             ? (tail ? evaluated.survival(*evaluated.graph.constant_value(*evaluated.bounds.lower))
                                     : evaluated.cumulative(*evaluated.graph.constant_value(*evaluated.bounds.lower)))
                             : 0;
    double distance = 0;
    for (int i = 0; i < n; ++i) {
      double const x = draws[static_cast<std::size_t>(i)];
      double const p = (tail ? start - evaluated.survival(x) : evaluated.cumulative(x) - start) / mass_inside;
      distance = std::max({distance, std::fabs(p - static_cast<double>(i) / n), std::fabs(p - static_cast<double>(i + 1) / n)});
    }
    CAPTURE(describe(given));
    CHECK(inside);
    CHECK(distance < threshold);
  }
}

TEST_CASE("a draw depends on its stream alone") {
  for (Case const& given : all_cases()) {
    Stream one(StreamKey{.seed = 3}), two(StreamKey{.seed = 3}), other(StreamKey{.seed = 4});
    double const x = draw(given.row(), given.arguments, given.lower, given.upper, one);
    CAPTURE(describe(given));
    CHECK(x == draw(given.row(), given.arguments, given.lower, given.upper, two));
    CHECK(x != draw(given.row(), given.arguments, given.lower, given.upper, other));
  }
}

TEST_CASE("the sampler's coordinate and the declared value invert each other") {
  for (Case const& given : all_cases()) {
    Evaluated evaluated(given);
    NodeId const back = unconstrain(evaluated.graph, evaluated.bounds, evaluated.leaf);
    Stream stream(StreamKey{.seed = 9});
    for (int i = 0; i < 20; ++i) {
      double const x = draw(given.row(), given.arguments, given.lower, given.upper, stream);
      double const again = evaluated.at(evaluated.coordinate.value, evaluated.at(back, x));
      CAPTURE(describe(given));
      CHECK(again == relative(x, 1e-12));
    }
  }
}

TEST_CASE("the log Jacobian matches a central difference") {
  constexpr double h = 1e-4;  // h^4 of a function whose derivatives are as large as itself
  for (Case const& given : all_cases()) {
    Evaluated const evaluated(given);
    for (double const u : {-9.0, -2.2, -0.4, 0.3, 1.9, 4.0}) {
      auto const x = [&](double by) { return evaluated.at(evaluated.coordinate.value, u + by); };
      double const slope = std::fabs((8 * (x(h) - x(-h)) - (x(2 * h) - x(-2 * h))) / (12 * h));
      // Rounding of x, divided by h, is a share of the slope.
      double const rounding = 4e-16 * std::fabs(x(0)) / (h * slope);
      CAPTURE(describe(given));
      CAPTURE(u);
      CHECK(std::fabs(evaluated.at(evaluated.coordinate.log_jacobian, u) - std::log(slope)) < 1e-8 + rounding);
    }
  }
}

TEST_CASE("coordinates far out stay inside the bounds and finite") {
  for (Case const& given : all_cases()) {
    Evaluated const evaluated(given);
    if (!evaluated.bounded()) continue;
    auto const bound = [&](std::optional<NodeId> const& node, double otherwise) {
      return node ? *evaluated.graph.constant_value(*node) : otherwise;
    };
    double const low = bound(evaluated.bounds.lower, -infinity), high = bound(evaluated.bounds.upper, infinity);
    for (double const u : {-700.0, -300.0, -50.0, 0.0, 50.0, 300.0, 700.0}) {
      double const x = evaluated.at(evaluated.coordinate.value, u);
      CAPTURE(describe(given));
      CAPTURE(u);
      CHECK(x > low);
      CHECK(x < high);
      CHECK(std::isfinite(x));
      CHECK(std::isfinite(evaluated.at(evaluated.coordinate.log_jacobian, u)));
      CHECK_FALSE(std::isnan(evaluated.at(evaluated.density, x)));
    }
  }
}

TEST_CASE("inadmissible arguments are refused with a reason, by draw as well") {
  for (DistributionRow const& row : distributions()) {
    std::vector<double> const none(row.arguments.size(), std::nan(""));
    std::vector<double> const negative(row.arguments.size(), -1.0);
    if (row.arguments.empty()) continue;
    CAPTURE(row.name);
    CHECK_FALSE(row.refuse(none).empty());
    CHECK_FALSE(row.refuse(negative).empty());
    Stream stream{StreamKey{}};
    CHECK_THROWS_AS(draw(row, none, -infinity, infinity, stream), UserError);
  }
  for (Case const& given : test::whole_cases()) CHECK(given.row().refuse(given.arguments).empty());
}

TEST_CASE("a noise is densest where its location is, and the saturated density is never below it") {
  for (Case const& given : test::whole_cases()) {
    DistributionRow const& row = given.row();
    if (!row.noise) continue;
    Evaluated evaluated(given);
    Graph& graph = evaluated.graph;
    NodeId const saturated = row.saturated(graph, evaluated.leaf, evaluated.use.arguments);
    double const centre = *graph.constant_value(row.centre(graph, evaluated.use.arguments));
    CAPTURE(describe(given));
    CHECK(evaluated.at(saturated, centre) == relative(evaluated.at(evaluated.density, centre), 1e-14));
    for (double const p : {0.001, 0.2, 0.6, 0.97}) {
      double const x = row.quantile(p, Tail::lower, given.arguments);
      CHECK(evaluated.at(saturated, x) > evaluated.at(evaluated.density, x));
    }
  }
}

TEST_CASE("a distribution twice as wide is twice as wide, about the same middle or from the same end at zero") {
  for (Case const& given : test::whole_cases()) {
    DistributionRow const& row = given.row();
    CAPTURE(describe(given));
    REQUIRE((row.widen != nullptr));
    std::vector<double> wider = given.arguments;
    row.widen(2, wider);
    if (!row.refuse(wider).empty()) {  // no beta distribution of its mean has twice its sd
      CHECK(row.name == "beta");
      CHECK(given.arguments[0] + given.arguments[1] < 3);
      continue;
    }
    std::vector<double> back = wider;
    row.widen(0.5, back);
    for (std::size_t i = 0; i < back.size(); ++i) CHECK(back[i] == relative(given.arguments[i], 1e-12));
    bool const of_logarithm = row.name == "log_uniform" || row.name == "log_normal";
    auto const spread = [&](std::vector<double> const& arguments) {
      double const low = row.quantile(0.25, Tail::lower, arguments), high = row.quantile(0.25, Tail::upper, arguments);
      return of_logarithm ? std::log(high / low) : high - low;
    };
    // Of shapes the sd doubles, or nearly so, and quantiles by other factors.
    bool const of_shape = row.name == "gamma" || row.name == "inverse_gamma" || row.name == "beta";
    if (!of_shape) CHECK(spread(wider) == relative(2 * spread(given.arguments), 1e-9));
    if (row.name == "gamma") {
      CHECK(wider[0] * wider[1] == doctest::Approx(given.arguments[0] * given.arguments[1]));
      CHECK(wider[1] * std::sqrt(wider[0]) == doctest::Approx(2 * given.arguments[1] * std::sqrt(given.arguments[0])));
    }
    if (row.name == "beta") {
      CHECK(wider[0] / wider[1] == doctest::Approx(given.arguments[0] / given.arguments[1]));
      CHECK(4 * (wider[0] + wider[1] + 1) == doctest::Approx(given.arguments[0] + given.arguments[1] + 1));
    }
  }
  std::vector<double> from_zero = {0, 10}, shifted = {2, 10};
  find_distribution("uniform")->widen(2, from_zero);
  find_distribution("uniform")->widen(2, shifted);
  CHECK(from_zero == std::vector<double>{0, 20});
  CHECK(shifted == std::vector<double>{-2, 14});
}

TEST_CASE("the moments of every noise are those of its draws") {
  int noises = 0;
  auto const check = [&](Case const& use) {
    DistributionRow const& row = use.row();
    REQUIRE((row.moments != nullptr));
    NoiseMoments const moments = row.moments(use.arguments);
    CAPTURE(use.name);
    constexpr int draws = 200'000;
    Stream stream({5, Purpose::test, static_cast<std::uint64_t>(++noises), 0});
    double sum = 0, squares = 0, fourth = 0;
    for (int i = 0; i < draws; ++i) {
      double const off = row.draw(stream, use.arguments) - moments.mean;
      sum += off;
      squares += off * off;
      fourth += off * off * off * off;
    }
    double const variance = squares / draws, error = std::sqrt((fourth / draws - variance * variance) / draws);
    CHECK(std::fabs(sum / draws) < 4 * std::sqrt(moments.variance / draws));
    // Heavy tails have variances that draws do not settle.
    if (fourth / draws < 20 * variance * variance) CHECK(std::fabs(variance - moments.variance) < 4 * error);
  };
  for (Case const& use : test::whole_cases())
    if (use.row().noise) check(use);
  for (Case const& use : test::count_cases()) check(use);
  CHECK(noises > 6);
  for (DistributionRow const& row : distributions()) CHECK((row.moments != nullptr) == row.noise);
  NoiseMoments const wide = find_distribution("log_normal")->moments(std::vector{0.1, 1.5});
  CHECK(wide.variance == doctest::Approx(0.01 * std::exp(2 * 2.25) - wide.mean * wide.mean));
  CHECK(std::isinf(find_distribution("student_t")->moments(std::vector{0.0, 2.0, 1.0}).variance));
}
