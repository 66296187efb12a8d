// `map` and `ml` against optima known in closed form.
#include "inference/optimum.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "diagnostics/verdict.hpp"
#include "inference/table.hpp"
#include "inference/targets.hpp"
#include "search/global/search.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// y_i ~ N(mean, 1/precision), both free: optimum at the sample's mean and 1/variance (divisor n).
TestTarget normal_sample(std::vector<double> const& y, Prior precision) {
  std::size_t const n = y.size();
  double const half = 0.5 * static_cast<double>(n), ceiling = half * std::log(1e6);
  return TestTarget({"mean", "precision"}, {{Prior::normal, 0, 10}, precision}, static_cast<int>(n) + 1,
                    ceiling - half * std::log(2 * std::numbers::pi), [=](std::vector<double> const& w, std::vector<double>& rows) {
                      for (std::size_t i = 0; i < n; ++i) rows[i] = std::sqrt(w[1]) * (y[i] - w[0]);
                      rows[n] = as_residual(half * std::log(w[1]), ceiling);
                    });
}

std::vector<double> const sample = {2.1, 1.7, 2.9, 2.4, 1.2, 2.0, 2.6, 1.9};
constexpr double n = 8, sample_mean = 2.1;

double variance() {
  double sum = 0;
  for (double const v : sample) sum += (v - sample_mean) * (v - sample_mean) / n;
  return sum;
}

}  // namespace

TEST_CASE("ml finds the sample mean and variance, with the sds of the Fisher information") {
  TestTarget const target = normal_sample(sample, {Prior::log_uniform, 0.01, 1000});
  Bench bench;
  FitResult const result = optimum::run_ml(target, Settings{}, bench.context);
  REQUIRE(result.draws.total() == 1);
  double const precision = 1 / variance();
  CHECK(result.draws.chains[0].values[0][0] == doctest::Approx(sample_mean).epsilon(1e-5));
  CHECK(result.draws.chains[0].values[0][1] == doctest::Approx(precision).epsilon(1e-4));
  // Differences of 0.3 sd bend the curvature of a gamma shape by h^2/12 of its fourth derivative: below one per cent.
  CHECK(result.modes[0].sd[0] == doctest::Approx(std::sqrt(variance() / n)).epsilon(0.01));
  CHECK(result.modes[0].sd[1] == doctest::Approx(precision * std::sqrt(2 / n)).epsilon(0.01));
  CHECK(result.draws.chains[0].log_likelihood[0] ==
        doctest::Approx(-0.5 * n * std::log(2 * std::numbers::pi * variance()) - 0.5 * n).epsilon(1e-9));
  CHECK(verdict_of(result.findings).pass);
}

TEST_CASE("map is the maximum of the density of the declared parameters, whatever the sampler's coordinate") {
  // log-uniform: p(precision) ~ 1/precision, so (n/2 - 1) log b - b n variance / 2 is largest at (n - 2)/(n variance);
  // with the Jacobian of the logarithm it would be at n/(n variance).
  Bench bench;
  FitResult const result = optimum::run_map(normal_sample(sample, {Prior::log_uniform, 1e-4, 1e5}), Settings{}, bench.context);
  CHECK(result.draws.chains[0].values[0][1] == doctest::Approx((n - 2) / (n * variance())).epsilon(2e-3));
  Bench uniform;
  FitResult const flat = optimum::run_map(normal_sample(sample, {Prior::uniform, 1e-4, 1e3}), Settings{}, uniform.context);
  CHECK(flat.draws.chains[0].values[0][1] == doctest::Approx(1 / variance()).epsilon(2e-3));
}

TEST_CASE("modes that a search has found are not searched for again") {
  std::vector<double> many;  // of eight the posterior is so far from normal that walkers would look at its widths
  for (int k = 0; k < 20; ++k) many.insert(many.end(), sample.begin(), sample.end());
  TestTarget const target = normal_sample(many, {Prior::log_uniform, 0.01, 1000});
  Bench first, second;
  SearchResult const found = search(target, ObjectiveKind::declared_posterior, first.context);
  second.context.modes = found.modes;
  second.context.mode_findings = {{FindingCode::flat_direction, Severity::warning, {}, "", ""}};
  auto const before = target.solves;
  FitResult const result = optimum::run_map(target, Settings{}, second.context);
  CHECK(target.solves < before + 500);  // its log likelihood, and the draws that its widths are checked by
  CHECK(result.draws.chains[0].values[0] == found.modes[0].declared);
  CHECK(result.search_told);
  CHECK(result.findings == second.context.mode_findings);
}

TEST_CASE("a point estimate has the standard deviations of its Laplace approximation") {
  Bench bench;
  FitResult const result = optimum::run_ml(normal_sample(sample, {Prior::uniform, 1e-4, 1e3}), Settings{}, bench.context);
  REQUIRE(result.summaries.size() == 2);
  // Fisher information of a normal sample of n: n precision for the mean, n / (2 precision^2) for the precision.
  CHECK(result.summaries[0].sd == doctest::Approx(std::sqrt(variance() / n)).epsilon(1e-2));
  CHECK(result.summaries[1].sd == doctest::Approx(std::sqrt(2.0 / n) / variance()).epsilon(1e-2));
  // One point has no quantiles.
  CHECK(std::isnan(result.summaries[0].q5));
  CHECK(std::isnan(result.summaries[0].q95));
}

TEST_CASE("an optimum at a bound of the prior is reported, one inside is not") {
  Bench bench, inside;
  FitResult const result =
      optimum::run_ml(normal_sample(sample, {Prior::uniform, 0.01, 0.5 / variance()}), Settings{}, bench.context);
  REQUIRE(result.findings.size() == 1);
  CHECK(result.findings[0].code == FindingCode::at_bound);
  CHECK(result.findings[0].message.find("precision") != std::string::npos);
  CHECK(result.draws.chains[0].values[0][1] == doctest::Approx(0.5 / variance()).epsilon(1e-4));
  CHECK(
      optimum::run_ml(normal_sample(sample, {Prior::uniform, 0.01, 5 / variance()}), Settings{}, inside.context).findings.empty());
}

TEST_CASE("map and ml are in the table beside mh, with their settings") {
  std::vector<std::string_view> names;
  for (BackendRow const& row : backends()) {
    names.push_back(row.name);
    CHECK_FALSE(row.summary.empty());
    CHECK(row.refuse(Settings(row.settings)).empty());
    for (SettingRow const& setting : row.settings) CHECK_FALSE(setting.summary.empty());
  }
  for (char const* name : {"mh", "map", "ml"}) {
    CHECK(std::count(names.begin(), names.end(), name) == 1);
    CHECK(find_backend(name)->name == name);
  }
  CHECK(find_backend("hmc") == nullptr);
}

TEST_CASE("a point estimate stopped in its search goes on to the same answer") {
  TestTarget const target = normal_sample(sample, {Prior::log_uniform, 0.01, 1000});
  Bench whole(4), first(4), second(4), other(5);
  FitResult const unbroken = optimum::run_map(target, Settings{}, whole.context);
  nlohmann::json saved;
  int asked = 0;
  first.context.interrupted = [&] { return ++asked > 2; };
  first.context.checkpoint = [&](nlohmann::json const& state) { saved = state; };
  REQUIRE(optimum::run_map(target, Settings{}, first.context).interrupted);
  second.context.resume = std::make_shared<nlohmann::json const>(saved);
  CHECK(optimum::run_map(target, Settings{}, second.context).draws.chains[0].values == unbroken.draws.chains[0].values);
  other.context.resume = std::make_shared<nlohmann::json const>(saved);
  CHECK(optimum::run_map(target, Settings{}, other.context).failure);
}
