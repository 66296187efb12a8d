// The global search: finds the optimum from the prior alone, weighs modes, spreads chains, and says when there is nothing to find.
#include "search/global/search.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <set>

#include "inference/targets.hpp"
#include "relative.hpp"
#include "replications.hpp"
#include "search/laplace.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// log of sum_i share_i N(x | centre_i, sd_i^2) as one residual row, under a nearly flat prior.
TestTarget mixture(std::vector<double> share, std::vector<double> centre, std::vector<double> sd) {
  return TestTarget({"x"}, {{Prior::normal, 0, 30}}, 1, 500, [=](std::vector<double> const& w, std::vector<double>& rows) {
    double best = -infinity, sum = 0;
    std::vector<double> terms;
    for (std::size_t i = 0; i < share.size(); ++i) {
      double const z = (w[0] - centre[i]) / sd[i];
      terms.push_back(std::log(share[i] / sd[i]) - 0.5 * z * z);
      best = std::max(best, terms.back());
    }
    for (double const t : terms) sum += std::exp(t - best);
    // A floor, as a residual must stay below the ceiling's reach.
    rows[0] = as_residual(std::max(best + std::log(sum), -1e6), 500);
  });
}

}  // namespace

TEST_CASE("Duffing's oscillator is found from draws two decades wide, for every record and seed") {
  for (std::uint64_t const seed : seeds(2, 8, 0)) {
    CAPTURE(seed);
    TestTarget const target = duffing(seed);
    Bench bench(1000 + seed);
    SearchResult const result = search(target, ObjectiveKind::posterior, bench.context);
    REQUIRE_FALSE(result.modes.empty());
    Mode const& best = result.modes.front();
    double const truth[] = {1, 20, 1e4, 5e9};
    for (std::size_t p = 0; p < 4; ++p) {
      CHECK(std::fabs(best.declared[p] - truth[p]) < 4 * best.sd[p]);
      CHECK(best.sd[p] < 0.01 * truth[p]);
    }
    CHECK(best.share > 0.999);
    CHECK(best.flat.empty());
    CHECK(result.findings.empty());
  }
}

TEST_CASE("modes are weighed by the mass below them, not by their height") {
  // The narrow mode is 7.5 times as high and holds a quarter; the third is too small to mention.
  TestTarget const target = mixture({0.746, 0.25, 0.004}, {-20, 10, 40}, {2, 0.0894, 1});
  Bench bench;
  SearchResult const result = search(target, ObjectiveKind::posterior, bench.context);
  REQUIRE(result.modes.size() >= 2);
  // The prior tilts each Gaussian: N(x | c, s^2) N(x | 0, t^2) integrates to N(c | 0, s^2 + t^2).
  auto const mass = [&](double share, double c, double s) {
    return share * std::exp(-0.5 * c * c / (900 + s * s)) / std::sqrt(1 + s * s / 900);
  };
  double const wide = mass(0.746, -20, 2), narrow = mass(0.25, 10, 0.0894), small = mass(0.004, 40, 1);
  CHECK(result.modes[0].share == doctest::Approx(wide / (wide + narrow + small)).epsilon(2e-3));
  CHECK(result.modes[1].share == relative(narrow / (wide + narrow + small), 6e-3));
  REQUIRE(result.findings.size() == 1);
  CHECK(result.findings[0].code == FindingCode::second_mode);
  CHECK(result.findings[0].message.find("x = 10") != std::string::npos);
}

TEST_CASE("several further modes are one finding, which describes the largest of them") {
  Bench bench;
  SearchResult const result = search(mixture({0.5, 0.2, 0.3}, {0, -20, 20}, {1, 1, 1}), ObjectiveKind::posterior, bench.context);
  REQUIRE(result.modes.size() == 3);
  REQUIRE(result.findings.size() == 1);
  std::string const& message = result.findings[0].message;
  CAPTURE(message);
  CHECK(message.starts_with("2 further modes have about 27, 18 % of the posterior mass, the largest at x = 19.98"));
}

TEST_CASE("one mode alone raises no warning") {
  TestTarget const target = mixture({1}, {3}, {0.5});
  Bench bench;
  SearchResult const result = search(target, ObjectiveKind::posterior, bench.context);
  CHECK(result.modes.size() == 1);
  CHECK(result.findings.empty());
  CHECK(result.modes[0].share == 1);
}

TEST_CASE("Laplace's mass of a Gaussian is its evidence") {
  // y_i ~ N(a, 1), a ~ N(0, 5^2): the evidence is known, and Laplace is exact.
  constexpr int n = 10;
  std::vector<double> const y = {1.2, 0.3, 0.8, 1.9, -0.4, 1.1, 0.6, 1.4, 0.2, 0.9};
  double const constant = -0.5 * n * std::log(2 * std::numbers::pi);
  TestTarget const target({"a"}, {{Prior::normal, 0, 5}}, n, constant,
                          [=](std::vector<double> const& w, std::vector<double>& rows) {
                            for (std::size_t i = 0; i < n; ++i) rows[i] = y[i] - w[0];
                          });
  double sum = 0, square = 0;
  for (double const v : y) {
    sum += v;
    square += v * v;
  }
  // Marginal covariance I + 25 11': determinant 1 + 25 n, inverse I - 25/(1 + 25 n) 11'.
  double const evidence = constant - 0.5 * std::log(1 + 25.0 * n) - 0.5 * (square - 25 / (1 + 25.0 * n) * sum * sum);
  Bench bench;
  SearchResult const result = search(target, ObjectiveKind::posterior, bench.context);
  CHECK(result.modes.front().log_mass == doctest::Approx(evidence).epsilon(1e-8));
  CHECK(result.modes.front().sd[0] == doctest::Approx(std::sqrt(1 / (n + 0.04))).epsilon(1e-6));
}

TEST_CASE("a combination that the data leave alone is reported") {
  // Only a + b is measured; `ml` has no prior to lean on.
  TestTarget const target({"a", "b"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 1}}, 1, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[0] + w[1] - 1) / 0.01; });
  Bench likelihood, posterior;
  SearchResult const flat = search(target, ObjectiveKind::likelihood, likelihood.context);
  REQUIRE(flat.findings.size() == 1);
  CHECK(flat.findings[0].code == FindingCode::flat_direction);
  CHECK(flat.findings[0].message.find("a combination of a and b") != std::string::npos);
  // The direction is (1, -1): a tenth of a prior width of each, in opposite senses.
  REQUIRE(flat.modes[0].flat.size() == 2);
  CHECK(std::fabs(flat.modes[0].flat[0]) == relative(0.1, 0.05));
  CHECK(flat.modes[0].flat[1] == relative(-flat.modes[0].flat[0], 1e-3));
  CHECK(search(target, ObjectiveKind::posterior, posterior.context).findings.empty());
}

TEST_CASE("a sum that alone is measured is reported for bounded priors, too, where one term is known better than the other") {
  TestTarget const target(
      {"a", "b"}, {{Prior::uniform, 0, 10}, {Prior::uniform, 0, 10}}, 1, 0,
      [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[0] + 0.5 * w[1] - 4) / 1e-5; });
  Bench bench;
  SearchResult const result = search(target, ObjectiveKind::likelihood, bench.context);
  CHECK(std::any_of(result.findings.begin(), result.findings.end(),
                    [](Finding const& each) { return each.code == FindingCode::flat_direction; }));
}

TEST_CASE("a value that the data hold at a bound is not called undetermined, one that they leave alone there is") {
  auto const at_bound = [](double width) {
    TestTarget const target({"z"}, {{Prior::log_uniform, 1e-4, 1}}, 1, 0,
                            [=](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = w[0] / width; });
    Bench bench;
    Findings const found = search(target, ObjectiveKind::likelihood, bench.context).findings;
    return std::any_of(found.begin(), found.end(), [](Finding const& each) { return each.code == FindingCode::flat_direction; });
  };
  for (double const width : {1e-4, 3e-4, 1e-3}) {
    CAPTURE(width);
    CHECK_FALSE(at_bound(width));
  }
  TestTarget const alone({"z", "q"}, {{Prior::log_uniform, 1e-4, 1}, {Prior::normal, 0, 1}}, 1, 0,
                         [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[1] - 1) / 0.01; });
  Bench bench;
  Findings const found = search(alone, ObjectiveKind::likelihood, bench.context).findings;
  CHECK(std::any_of(found.begin(), found.end(), [](Finding const& each) { return each.code == FindingCode::flat_direction; }));
}

TEST_CASE("directions of the same parameters are told once") {
  // Nothing but the sum of three is measured: two directions, of the same three.
  TestTarget const target(
      {"a", "b", "c"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 1}, {Prior::normal, 0, 1}}, 1, 0,
      [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[0] + w[1] + w[2] - 1) / 0.01; });
  Bench bench;
  SearchResult const result = search(target, ObjectiveKind::likelihood, bench.context);
  CHECK(result.modes[0].flat.size() == 6);
  std::set<std::vector<std::string>> names;
  for (Finding const& each : result.findings) CHECK(names.insert(each.names).second);
  CHECK_FALSE(names.empty());
}

TEST_CASE("a parameter that the data leave alone is named by itself") {
  TestTarget const target({"a", "idle"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 1}}, 1, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[0] - 1) / 0.01; });
  Bench bench;
  SearchResult const result = search(target, ObjectiveKind::likelihood, bench.context);
  REQUIRE(result.findings.size() == 1);
  CHECK(result.findings[0].message == "the data do not determine idle: its posterior is as wide as its prior");
}

TEST_CASE("a parameter known to a billionth leaves the others their widths") {
  TestTarget const target({"stiff", "soft"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 1}}, 2, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) {
                            rows[0] = (w[0] - 0.5) / 1e-9;
                            rows[1] = (w[1] - 1) / 0.1;
                          });
  Bench bench;
  SearchResult const result = search(target, ObjectiveKind::posterior, bench.context);
  CHECK(result.findings.empty());
  CHECK(result.modes.front().sd[0] == relative(1e-9, 1e-3));
  CHECK(result.modes.front().sd[1] == relative(std::sqrt(1 / 101.0), 1e-3));
}

TEST_CASE("an optimum is the highest mode, and a lower one that holds more is reported with its share") {
  TestTarget const target = mixture({0.75, 0.25}, {-20, 10}, {2, 0.0894});
  Bench bench;
  SearchResult const result = search(target, ObjectiveKind::declared_posterior, bench.context);
  REQUIRE(result.modes.size() == 2);
  CHECK(result.modes[0].declared[0] == doctest::Approx(10).epsilon(1e-3));
  // By the prior's tilt 0.75 and 0.25 become 0.71 and 0.29 of their sum, see above.
  double const wide = 0.75 * std::exp(-0.5 * 400 / 904) / std::sqrt(904.0), narrow = 0.25 * std::exp(-0.5 * 100 / 900) / 30;
  CHECK(result.modes[1].share == doctest::Approx(wide / (wide + narrow)).epsilon(5e-3));
  REQUIRE(result.findings.size() == 1);
  CHECK(result.findings[0].code == FindingCode::second_mode);
}

TEST_CASE("progress counts simulations up to those of a usual search") {
  struct Counting : SilentProgress {
    std::uint64_t total = 0, last = 0;
    int calls = 0;
    bool finished = false;
    void begin(std::string_view, std::uint64_t of) override { total = of; }
    void expect(std::uint64_t of) override { total = of; }
    void advance(std::uint64_t done, std::string_view) override {
      CHECK(done >= last);
      last = done;
      ++calls;
    }
    void end(bool whole) override { finished = whole; }
  } progress;
  TestTarget const target = mixture({1}, {3}, {0.5});
  Ledger ledger;
  RunContext context{1, progress, ledger};
  search(target, ObjectiveKind::posterior, context);
  CHECK(progress.calls > 10);
  CHECK(progress.last < progress.total);
  CHECK(progress.last > 2048);
  CHECK(progress.finished);
  Ledger again;
  RunContext stopped{1, progress, again};
  stopped.interrupted = [&] { return again.solves() > 3000; };
  progress.last = 0;
  CHECK(search(target, ObjectiveKind::posterior, stopped).interrupted);
  CHECK_FALSE(progress.finished);
}

TEST_CASE("a prior without a solvable point is a failure that names the place") {
  TestTarget const target({"x"}, {{Prior::uniform, 0, 1}}, 1, 0,
                          [](std::vector<double> const&, std::vector<double>& rows) { rows[0] = infinity; });
  Bench bench;
  SearchResult const result = search(target, ObjectiveKind::posterior, bench.context);
  REQUIRE(result.failure);
  CHECK(result.failure->severity == Severity::error);
  CHECK(result.failure->message.find("not finite at any of 8192 draws") != std::string::npos);
  CHECK(result.failure->message.find("the test's residual at t = ") != std::string::npos);
}

TEST_CASE("solvable points are used however rare they are") {
  // Finite for one draw in two hundred.
  TestTarget const target({"x"}, {{Prior::uniform, 0, 1}}, 1, 0, [](std::vector<double> const& w, std::vector<double>& rows) {
    rows[0] = w[0] < 0.005 ? (w[0] - 0.002) / 0.0005 : infinity;
  });
  Bench bench;
  SearchResult const result = search(target, ObjectiveKind::posterior, bench.context);
  REQUIRE_FALSE(result.failure);
  CHECK(result.modes.front().declared[0] == relative(0.002, 0.2));
  CHECK(bench.ledger.failed() > 1000);
}
