// Fits of linear equations that state no solver: exact steps where those of the usual solver grow without bound on a part of the
// prior, with the evidence of a grid over a closed form; else what it was.
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/running.hpp"
#include "core/numeric/random.hpp"
#include "relative.hpp"

using namespace sysid;
using nlohmann::json;

namespace exact_default_tests {
namespace {

constexpr double noise = 0.05;

struct Record {
  std::vector<double> time, input, level;
};

/// fast*a' = u - a, slow*b' = a - b from rest, u held: b at the samples.
std::vector<double> lagged(Record const& record, double fast, double slow) {
  double a = 0, b = 0;
  std::vector<double> result{b};
  for (std::size_t i = 0; i + 1 < record.time.size(); ++i) {
    double const h = record.time[i + 1] - record.time[i], u = record.input[i], of_fast = std::exp(-h / fast),
                 of_slow = std::exp(-h / slow);
    b = u + (b - u) * of_slow + (a - u) * fast / (fast - slow) * (of_fast - of_slow);
    a = u + (a - u) * of_fast;
    result.push_back(b);
  }
  return result;
}

Record made(bool equal) {
  Stream stream({.seed = 3, .purpose = Purpose::test, .index = equal ? 0u : 1u, .step = 0});
  Record record;
  double time = 0, input = 0;
  for (int i = 0; i < 120; ++i) {
    record.time.push_back(time);
    if (i % 8 == 0) input = std::round(1e3 * stream.normal()) / 1e3;
    record.input.push_back(input);
    time += equal || i % 5 > 0 ? 1 : i % 15 == 0 ? 2.5 : 1.25 + i / 128.0;
  }
  record.level = lagged(record, 0.05, 20);
  for (double& each : record.level) each = std::round(1e6 * (each + noise * stream.normal())) / 1e6;
  return record;
}

std::string csv(Record const& record) {
  std::string text = "t,u,y\n";
  for (std::size_t i = 0; i < record.time.size(); ++i)
    text += fmt::format("{:.17g},{:.17g},{:.17g}\n", record.time[i], record.input[i], record.level[i]);
  return text;
}

std::string lags(std::string const& prior_of_fast, std::string const& options) {
  return fmt::format(R"(
model lags {{
  input u
  state a, b
  initial a = 0, b = 0
  parameter fast [s] ~ {}
  parameter slow [s] ~ log_uniform(2, 200)
  fast*a' = u - a
  slow*b' = a - b
  observe level ~ normal(b, sd = {})
}}
data bench {{
  file "lags.csv"
  time t [s]
  input u = u hold zero_order
  measure level = y
}}
posterior = fit lags to bench with mh(samples = 6000, burn_in = 1500, thin = 3, chains = 4), seed = 1{}
)",
                     prior_of_fast, noise, options);
}

/// By the trapezoidal rule over the logarithms of both.
struct Reference {
  double log_evidence = 0, mean_fast = 0;
};
Reference reference(Record const& record, double least, double most) {
  constexpr int n = 300;
  double const low[] = {std::log(least), std::log(10.0)}, high[] = {std::log(most), std::log(40.0)};
  double const step[] = {(high[0] - low[0]) / n, (high[1] - low[1]) / n};
  double const norm = -static_cast<double>(record.time.size()) * std::log(noise * std::sqrt(2 * std::numbers::pi));
  std::vector<double> log_density, fast;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      fast.push_back(std::exp(low[0] + i * step[0]));
      std::vector<double> const level = lagged(record, fast.back(), std::exp(low[1] + j * step[1]));
      double squares = 0;
      for (std::size_t k = 0; k < level.size(); ++k) squares += std::pow((record.level[k] - level[k]) / noise, 2);
      double const weight = (i % n == 0 ? 0.5 : 1) * (j % n == 0 ? 0.5 : 1);
      log_density.push_back(norm - squares / 2 + std::log(weight * step[0] * step[1]));
    }
  double const top = *std::ranges::max_element(log_density);
  Reference result;
  double sum = 0;
  for (std::size_t k = 0; k < fast.size(); ++k) {
    double const part = std::exp(log_density[k] - top);
    sum += part;
    result.mean_fast += part * fast[k];
  }
  result.mean_fast /= sum;
  result.log_evidence = top + std::log(sum) - std::log(std::log(most / least)) - std::log(std::log(100.0));
  return result;
}

bool has_finding(json const& summary, std::string const& code) {
  return std::ranges::any_of(summary.at("findings"), [&](json const& each) { return each.at("code") == code; });
}

}  // namespace

TEST_CASE("a prior that reaches far below the samples is fitted by exact steps, at equal intervals and at others") {
  for (bool const equal : {true, false}) {
    CAPTURE(equal);
    Record const record = made(equal);
    CaseRun const run(lags("log_uniform(1e-3, 10)", ""), {{"lags.csv", csv(record)}});
    json const summary = run.summary("posterior");
    CHECK(summary.at("settings").at("solver") == "exponential");
    CHECK_FALSE(summary.at("settings").contains("substeps"));
    CHECK(run.result.notices.find("the integration is unstable for") != std::string::npos);
    CHECK_FALSE(has_finding(summary, "stiff_prior"));
    CHECK_FALSE(has_finding(summary, "failed_solves"));
    Reference const expected = reference(record, 1e-3, 10);
    CHECK(summary.at("evidence").at("log_evidence").get<double>() == doctest::Approx(expected.log_evidence).epsilon(1e-4));
    CHECK(parameter(summary, "fast").at("mean").get<double>() == relative(expected.mean_fast, 0.08));
    // The run states what it did, and does it again.
    std::string const resolved = run.file("posterior/resolved.sysid");
    CHECK(resolved.find("solver = exponential") != std::string::npos);
  }
}

TEST_CASE("a prior that the usual steps follow, and a solver that is stated, are kept") {
  Record const record = made(true);
  CaseRun const mild(lags("log_uniform(1, 10)", ""), {{"lags.csv", csv(record)}});
  json const summary = mild.summary("posterior");
  CHECK(summary.at("settings").at("solver") == "rk4");
  CHECK(mild.result.notices.find("unstable") == std::string::npos);
  CaseRun const stated(lags("log_uniform(1e-3, 10)", ", solver = rk4"), {{"lags.csv", csv(record)}});
  CHECK(stated.summary("posterior").at("settings").at("solver") == "rk4");
}

TEST_CASE("exact steps that a fit has chosen give way to adaptive ones where a prediction's input is curved") {
  Record const record = made(true);
  std::string const text = lags("log_uniform(1e-3, 10)", "") + R"(
data curved {
  file "lags.csv"
  time t [s]
  input u = u hold cubic
  measure level = y
}
same  = predict posterior on bench with draws(20), seed = 1
other = predict posterior on curved with draws(20), seed = 1
)";
  CaseRun const run(text, {{"lags.csv", csv(record)}});
  CHECK(run.file("same/summary.json").size() > 0);
  CHECK(run.file("other/summary.json").size() > 0);
}

}  // namespace exact_default_tests
