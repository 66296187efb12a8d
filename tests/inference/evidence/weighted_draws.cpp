// Weighted draws against posteriors that are known, and what `map` and the evidence make of them.
#include "inference/evidence/weighted_draws.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "inference/evidence/laplace.hpp"
#include "inference/optimum.hpp"
#include "inference/targets.hpp"
#include "relative.hpp"
#include "search/global/search.hpp"

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

/// Saturation kinetics S' = -V S/(Km + S) from a known start: Km ln S + S falls by V t.
double log_substrate(double t, double v, double km, double guess) {
  double const rest = km * std::log(2.0) + 2.0 - v * t;
  double x = guess;
  for (int round = 0; round < 60; ++round) {
    double const step = std::clamp((km * x + std::exp(x) - rest) / (km + std::exp(x)), -3.0, 3.0);
    x -= step;
    if (std::fabs(step) < 1e-10) break;
  }
  return x;
}

/// Differences from a record at V = 0.8, Km = 3 with errors of that size.
std::vector<double> kinetic_errors(double v, double km, double size) {
  constexpr int rows = 40;
  std::vector<double> errors;
  double x = std::log(2.0), truth = std::log(2.0);
  for (int i = 0; i < rows; ++i) {
    double const t = 6.0 * i / (rows - 1);
    x = log_substrate(t, v, km, x);
    truth = log_substrate(t, 0.8, 3, truth);
    errors.push_back(std::exp(truth) + size * (std::sin(2.4 * i) + 0.6 * std::cos(5.1 * i + 1)) - std::exp(x));
  }
  return errors;
}

TestTarget kinetics(double size) {
  constexpr double lowest = 1e-4;
  double const ceiling = -40 * std::log(lowest);
  return TestTarget({"V", "Km", "sigma"},
                    {{Prior::log_uniform, 0.01, 100}, {Prior::log_uniform, 0.05, 100}, {Prior::log_uniform, lowest, 1}}, 41,
                    ceiling, [=](std::vector<double> const& w, std::vector<double>& r) {
                      r = kinetic_errors(w[0], w[1], size);
                      for (double& each : r) each /= w[2];
                      r.push_back(as_residual(-40 * std::log(w[2]), ceiling));
                    });
}

/// sd of V and Km by the midpoint rule over ln Km and the initial rate; sigma is integrated in closed form: its prior is wide.
std::vector<double> kinetic_sds(double size) {
  constexpr int steps = 120;
  double least = 1e9, sum = 0;
  std::vector<double> mean(2), square(2), squares, km, v;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j) {
      km.push_back(0.05 * std::pow(2000, (i + 0.5) / steps));
      v.push_back((0.25 + 0.15 * (j + 0.5) / steps) * (km.back() + 2) / 2);
      squares.push_back(0);
      for (double const each : kinetic_errors(v.back(), km.back(), size)) squares.back() += each * each;
      least = std::min(least, squares.back());
    }
  for (std::size_t k = 0; k < squares.size(); ++k) {
    double const weight = std::pow(squares[k] / least, -20) * (km[k] + 2) / v[k];
    std::vector<double> const here = {v[k], km[k]};
    sum += weight;
    for (std::size_t p = 0; p < 2; ++p) mean[p] += weight * here[p], square[p] += weight * here[p] * here[p];
  }
  std::vector<double> sds;
  for (std::size_t p = 0; p < 2; ++p) sds.push_back(std::sqrt(square[p] / sum - mean[p] * mean[p] / (sum * sum)));
  return sds;
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
    CHECK(draws.sd[p] == relative(modes.front().sd[p], 1e-3));
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

TEST_CASE("a tail that weighted draws miss is found by walkers, and map fails") {
  for (double const size : {0.03, 0.04}) {
    CAPTURE(size);
    TestTarget const target = kinetics(size);
    std::vector<double> const truth = kinetic_sds(size);
    Bench bench, other;
    FitResult const fitted = optimum::run_map(target, Settings{}, bench.context);
    for (std::size_t p = 0; p < 2; ++p) REQUIRE(truth[p] > 1.6 * fitted.modes.front().sd[p]);
    REQUIRE(widths_finding(fitted) != nullptr);
    CHECK(widths_finding(fitted)->severity == Severity::error);
    CHECK(widths_finding(fitted)->names.size() == 2);
    std::vector<Mode> const modes = search(target, ObjectiveKind::posterior, other.context).modes;
    WeightedDraws const draws = weighted_draws(target, modes, 1, other.ledger, {}, &modes.front());
    CHECK(draws.walked);
    // Of the larger noise the tail reaches the bound of the prior, ten sds away: too far to measure, but not to be missed.
    for (std::size_t p = 0; p < 2; ++p)
      if (size < 0.035)
        CHECK(draws.sd[p] == relative(truth[p], 0.25));
      else
        CHECK(draws.sd[p] > 1.5 * fitted.modes.front().sd[p]);
  }
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
