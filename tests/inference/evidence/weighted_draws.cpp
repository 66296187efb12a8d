// Weighted draws against posteriors that are known, and what `map` and the evidence make of them.
#include "inference/evidence/weighted_draws.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "inference/evidence/laplace.hpp"
#include "inference/optimum.hpp"
#include "inference/targets.hpp"
#include "search/search.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// Normal noise of estimated size: the posterior of few rows is that of Student's t.
TestTarget sample_of(std::vector<double> const& y, double lowest, double highest) {
  auto const n = static_cast<double>(y.size());
  double const ceiling = -n * std::log(lowest);
  return TestTarget({"mean", "sigma"}, {{Prior::normal, 0, 10}, {Prior::log_uniform, lowest, highest}},
                    static_cast<int>(y.size()) + 1, ceiling - 0.5 * n * std::log(2 * std::numbers::pi),
                    [=](std::vector<double> const& w, std::vector<double>& r) {
                      for (std::size_t i = 0; i < y.size(); ++i) r[i] = (y[i] - w[0]) / w[1];
                      r[y.size()] = as_residual(-n * std::log(w[1]), ceiling);
                    });
}

/// By the midpoint rule over the mean and the logarithm of the sd.
double evidence_of(std::vector<double> const& y, double lowest, double highest) {
  constexpr int steps = 600;
  double sum = 0;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j) {
      double const mean = -12 + 24 * (i + 0.5) / steps, sigma = lowest * std::pow(highest / lowest, (j + 0.5) / steps);
      double log_density = -0.5 * mean * mean / 100 - 0.5 * std::log(2 * std::numbers::pi * 100);
      for (double const v : y)
        log_density -= 0.5 * (v - mean) * (v - mean) / (sigma * sigma) + std::log(sigma * std::sqrt(2 * std::numbers::pi));
      sum += std::exp(log_density) * 24 / steps / steps;
    }
  return std::log(sum);
}

std::vector<double> few_rows(int count) {
  std::vector<double> y;
  for (int i = 0; i < count; ++i) y.push_back(1 + 0.5 * std::sin(2.4 * i) + 0.3 * std::cos(5.1 * i));
  return y;
}

/// A straight line: normal in everything.
TestTarget straight_line() {
  return TestTarget({"a", "b"}, {{Prior::normal, 0, 10}, {Prior::normal, 0, 10}}, 20, 0,
                    [](std::vector<double> const& w, std::vector<double>& r) {
                      for (int i = 0; i < 20; ++i) r[static_cast<std::size_t>(i)] = (1 + 2 * i - w[0] - w[1] * i) / 0.5;
                    });
}

/// A slow relaxation seen at its beginning: only the initial slope is known, and amplitude and time constant go together far
/// beyond the curvature at the optimum.
TestTarget slow_relaxation() {
  return TestTarget({"amplitude", "tau"}, {{Prior::uniform, 0, 400}, {Prior::log_uniform, 10, 1e4}}, 100, 0,
                    [](std::vector<double> const& w, std::vector<double>& r) {
                      for (int i = 0; i < 100; ++i) {
                        double const t = 0.3 * i, y = 30 * (1 - std::exp(-t / 300)) + 0.01 * std::sin(17.0 * i);
                        r[static_cast<std::size_t>(i)] = (y - w[0] * (1 - std::exp(-t / w[1]))) / 0.1;
                      }
                    });
}

Finding const* widths_finding(FitResult const& result) {
  auto const found = std::find_if(result.findings.begin(), result.findings.end(),
                                  [](Finding const& each) { return each.code == FindingCode::widths_not_normal; });
  return found == result.findings.end() ? nullptr : &*found;
}

}  // namespace

TEST_CASE("draws from a normal posterior confirm its evidence and widths exactly, by one round") {
  Bench bench;
  std::vector<Mode> const modes = search(straight_line(), ObjectiveKind::posterior, bench.context).modes;
  WeightedDraws const draws = weighted_draws(straight_line(), modes, 1, bench.ledger, {});
  CHECK(draws.draws == 300);
  CHECK(draws.effective > 200);
  CHECK(draws.log_evidence == doctest::Approx(modes.front().log_mass).epsilon(1e-6));
  CHECK(draws.error < 1e-4);
  for (std::size_t p = 0; p < 2; ++p) {
    CHECK(draws.sd[p] == doctest::Approx(modes.front().sd[p]).epsilon(1e-3));
    CHECK(std::fabs(draws.mean[p] - modes.front().declared[p]) < 1e-3 * modes.front().sd[p]);
  }
}

TEST_CASE("the evidence of few rows is corrected by weighted draws, that of many is confirmed") {
  for (int const count : {4, 10, 60}) {
    CAPTURE(count);
    TestTarget const target = sample_of(few_rows(count), 0.01, 10);
    Bench bench;
    std::vector<Mode> const modes = search(target, ObjectiveKind::posterior, bench.context).modes;
    Evidence const found = laplace_evidence(target, ObjectiveKind::posterior, modes, 1, bench.ledger);
    double const off = evidence_of(few_rows(count), 0.01, 10) - *found.log_evidence;
    REQUIRE(found.sampled.state == SampledEvidence::State::known);
    CHECK(std::fabs(found.sampled.above - off) < 3 * found.sampled.error + 0.02);
    CHECK(found.sampled.error < 0.1);
    CHECK(found.sampled.differs() == (count == 4));
    CHECK((std::fabs(off) > 0.2) == (count == 4));
  }
}

TEST_CASE("map fails where the posterior is far wider than its normal distribution, and not where it is normal") {
  Bench far, near, many;
  FitResult const wide = optimum::run_map(slow_relaxation(), Settings{}, far.context);
  REQUIRE(widths_finding(wide) != nullptr);
  CAPTURE(widths_finding(wide)->message);
  CHECK(widths_finding(wide)->severity == Severity::error);
  CHECK(widths_finding(optimum::run_map(straight_line(), Settings{}, near.context)) == nullptr);
  CHECK(widths_finding(optimum::run_map(sample_of(few_rows(200), 0.01, 10), Settings{}, many.context)) == nullptr);
}

TEST_CASE("a mode close to a bound has an evidence") {
  // ln a ~ N(-16, 0.3) under a uniform prior on (0, 1): a ten-millionth of the interval from its end.
  TestTarget const target({"alpha"}, {{Prior::uniform, 0, 1}}, 1, 0,
                          [](std::vector<double> const& a, std::vector<double>& r) { r[0] = (std::log(a[0]) + 16) / 0.3; });
  Bench bench;
  std::vector<Mode> const modes = search(target, ObjectiveKind::declared_posterior, bench.context).modes;
  Evidence const found = laplace_evidence(target, ObjectiveKind::declared_posterior, modes, 1, bench.ledger);
  CAPTURE(found.reason);
  REQUIRE(found.log_evidence);
  CHECK(*found.log_evidence == doctest::Approx(std::log(0.3 * std::sqrt(2 * std::numbers::pi)) - 16 + 0.045).epsilon(0.002));
}
