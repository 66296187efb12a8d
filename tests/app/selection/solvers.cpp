// A selection searches its candidates as fits of them are searched: with exact steps where those of `rk4` would lose a part of the
// prior, on first rows where the whole record hides the mode. Its predictions use the solvers of its particles.
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <vector>

#include "app/running.hpp"
#include "app/selection/selection_checks.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

constexpr double lag_step = 1, lag_noise = 0.05;

/// A quick lag under a held random input.
struct LagRecord {
  std::vector<double> input, level;

  LagRecord() {
    constexpr double tau = 0.2;
    Stream stream({.seed = 3, .purpose = Purpose::test, .index = 0, .step = 0});
    double x = 0;
    for (int i = 0; i < 60; ++i) {
      input.push_back(stream.normal());
      level.push_back(x + lag_noise * stream.normal());
      x = input.back() + (x - input.back()) * std::exp(-lag_step / tau);
    }
  }
  std::string text() const {
    std::string rows = "t,u,y\n";
    for (std::size_t i = 0; i < input.size(); ++i) rows += fmt::format("{},{:.17g},{:.17g}\n", i, input[i], level[i]);
    return rows;
  }
  double log_likelihood(double tau) const {
    double x = 0, sum = 0;
    for (std::size_t i = 0; i < input.size(); ++i) {
      double const z = (level[i] - x) / lag_noise;
      sum += -0.5 * z * z - std::log(lag_noise * std::sqrt(2 * std::acos(-1.0)));
      x = input[i] + (x - input[i]) * std::exp(-lag_step / tau);
    }
    return sum;
  }
  /// Over a log-uniform prior, by the trapezoidal rule.
  double log_evidence(double low, double high) const {
    constexpr int cells = 20'000;
    double const width = std::log(high / low) / cells;
    std::vector<double> logs;
    for (int i = 0; i <= cells; ++i) logs.push_back(log_likelihood(low * std::exp(i * width)));
    double const best = *std::max_element(logs.begin(), logs.end());
    double sum = 0;
    for (int i = 0; i <= cells; ++i) sum += (i == 0 || i == cells ? 0.5 : 1) * std::exp(logs[static_cast<std::size_t>(i)] - best);
    return best + std::log(sum / cells);
  }
};

std::string lag_model(std::string const& name, std::string const& prior) {
  return "model " + name + " {\n  input u\n  state x\n  initial x = 0\n  parameter tau [s] ~ " + prior +
         "\n  tau*x' = u - x\n  observe level ~ normal(x, sd = 0.05)\n}\n";
}

std::string const lag_data = "data bench { file \"lag.csv\"; time t [s]; input u = u hold zero_order; measure level = y }\n";

}  // namespace

TEST_CASE("a candidate whose steps would grow is stepped exactly, and its evidence is right") {
  LagRecord const record;
  CaseRun const run(
      lag_model("quick", "log_uniform(1e-3, 10)") + lag_model("narrow", "log_uniform(0.15, 0.3)") + lag_data +
          "candidates lags { quick; narrow }\n" +
          "selection = select lags to bench with reversible_jump(samples = 1000, burn_in = 200, pilot = 400), seed = 1\n"
          "again = predict selection on bench with draws(50), seed = 1\n",
      {{"lag.csv", record.text()}});
  CHECK(run.result.notices.find("quick: the exact solver exponential is used") != std::string::npos);
  json const summary = run.summary("selection");
  struct Expected {
    char const* name;
    double low, high;
  };
  for (Expected const& each : {Expected{"quick", 1e-3, 10}, Expected{"narrow", 0.15, 0.3}}) {
    json const& model = summary.at("models").at(each.name);
    CAPTURE(each.name);
    CHECK(model.at("simulated_with").at("solver") == "exponential");
    CHECK(std::fabs(model.at("log_evidence").get<double>() - record.log_evidence(each.low, each.high)) <
          0.02 + 4 * model.at("log_evidence_error").get<double>());
  }
  CHECK(run.summary("again").at("settings").at("solver") == "exponential");
}

TEST_CASE("`abc_smc` steps a linear candidate exactly, and what cannot be stepped so is predicted by the stated solver") {
  LagRecord const record;
  std::string const smooth = "data smooth { file \"lag.csv\"; time t [s]; input u = u hold cubic; measure level = y }\n";
  CaseRun const run(
      lag_model("quick", "log_uniform(1e-3, 10)") + lag_data + smooth +
          "candidates lags { quick }\n"
          "selection = select lags to bench with abc_smc(particles = 100, populations = 4, cross_check = no), seed = 1\n"
          "held = predict selection on bench with draws(20), seed = 1\n"
          "other = predict selection on smooth with draws(20), seed = 1\n",
      {{"lag.csv", record.text()}});
  json const summary = run.summary("selection");
  CHECK(summary.at("models").at("quick").at("simulated_with").at("solver") == "exponential");
  for (json const& each : summary.at("findings")) CHECK(each.at("code") != "step_not_settled");
  CHECK(run.summary("held").at("settings").at("solver") == "exponential");
  CHECK(run.summary("other").at("settings").at("solver") != "exponential");
}

namespace {

/// One model whose finer solver adds `shift` to every distance.
class ShiftedDistances : public SelectionTarget {
 public:
  ShiftedDistances(SelectedModel const& coarse, double shift) : coarse_(coarse), shift_(shift) {}
  int size() const override { return 1; }
  std::string const& name(int) const override { return coarse_.name; }
  double prior_probability(int) const override { return 1; }
  std::span<ParameterInfo const> parameters(int) const override { return coarse_.parameters; }
  void sample_prior(int, StreamKey, Lanes) const override {}
  void log_prior(int, ConstLanes, std::span<double>, bool) const override {}
  void constrain(int, ConstLanes, Lanes) const override {}
  void unconstrain(int, ConstLanes, Lanes) const override {}
  void distances(std::span<Batch const> batches, double) const override {
    for (std::size_t i = 0; i < batches[0].distance.size(); ++i) batches[0].distance[i] = coarse_.distance[i] + shift_;
  }
  std::pair<std::string, double> failure(int, ConstLanes) const override { return {}; }
  void parallel(int tasks, std::function<void(int)> const& task) const override {
    for (int i = 0; i < tasks; ++i) task(i);
  }

 private:
  SelectedModel const& coarse_;
  double shift_;
};

}  // namespace

TEST_CASE("distances that a finer solver changes are a warning, and an error where they change by the threshold") {
  SelectionResult result;
  result.threshold = 2;
  SelectedModel& selected = result.models.emplace_back();
  selected.name = "m";
  selected.theta = LaneArray(1, 50);
  selected.distance.assign(50, 1.5);
  auto const found = [&](double shift, SolverSettings const& solver = {}) {
    return check_distances(ShiftedDistances(result.models.front(), shift), 0, result, solver);
  };
  CHECK(found(0.05).empty());
  REQUIRE(found(0.5).size() == 1);
  CHECK(found(0.5).front().severity == Severity::warning);
  REQUIRE(found(2.5).size() == 1);
  CHECK(found(2.5).front().severity == Severity::error);
  CHECK(found(std::numeric_limits<double>::infinity()).front().severity == Severity::error);
  SolverSettings model;
  model.as_model = true;
  CHECK(found(2.5, model).empty());
}

TEST_CASE("predictions of a selection are integrated as its particles were") {
  // Between samples 0.5 s apart this oscillator makes one and a half turns: the task's own steps are refined.
  std::string rows = "t,y\n";
  Stream stream({.seed = 4, .purpose = Purpose::test, .index = 0, .step = 0});
  for (int i = 0; i < 40; ++i) rows += fmt::format("{},{:.9g}\n", 0.5 * i, std::cos(4.0 * 0.5 * i) + 0.02 * stream.normal());
  auto const swing = [](std::string const& name, std::string const& term) {
    return "model " + name + " {\n  state y\n  initial y = 1, y' = 0\n  parameter w [1/s] ~ normal(4, sd = 0.2)\n" +
           "  y'' + w^2*" + term + " = 0\n  observe place ~ normal(y, sd = 0.02)\n}\n";
  };
  CaseRun const run(
      swing("hard", "(y + 0.01*y^3)") + swing("soft", "sin(y)") +
          "data bench { file \"swing.csv\"; time t [s]; measure place = y }\n"
          "candidates swings { hard; soft }\n"
          "selection = select swings to bench with reversible_jump(samples = 600, burn_in = 200, pilot = 300), seed = 1\n"
          "again = predict selection on bench with draws(50), seed = 1\n",
      {{"swing.csv", rows}});
  json const models = run.summary("selection").at("models");
  json const& best = models.at("hard").at("probability") > 0.5 ? models.at("hard") : models.at("soft");
  int const steps = best.at("simulated_with").at("substeps").get<int>();
  CHECK(steps > 1);
  CHECK(run.summary("again").at("settings").at("substeps").get<int>() == steps);
}

TEST_CASE("draws of candidates that a finer solver moves are reported, of the most probable one as an error") {
  std::string rows = "t,y\n";
  Stream stream({.seed = 5, .purpose = Purpose::test, .index = 0, .step = 0});
  for (int i = 0; i < 40; ++i) rows += fmt::format("{},{:.9g}\n", 0.2 * i, std::cos(4.0 * 0.2 * i) + 0.02 * stream.normal());
  auto const selected = [&](std::string const& steps) {
    CaseRun const run(
        "model hard {\n  state y\n  initial y = 1, y' = 0\n  parameter w [1/s] ~ normal(4, sd = 0.5)\n  y'' + w^2*(y + 0.01*y^3) = "
        "0\n"
        "  observe place ~ normal(y, sd = 0.02)\n}\n"
        "model still {\n  state y\n  initial y = 1\n  parameter a [1/s] ~ normal(0, sd = 1)\n  y' = -a*y + 0.001*y^2*a\n"
        "  observe place ~ normal(y, sd = 0.02)\n}\n"
        "data bench { file \"swing.csv\"; time t [s]; measure place = y }\ncandidates swings { hard; still }\n"
        "selection = select swings to bench with reversible_jump(samples = 600, burn_in = 200, pilot = 300), solver = rk4(substeps "
        "= " +
            steps + "), seed = 1\n",
        {{"swing.csv", rows}});
    std::vector<std::string> severities;
    json const summary = run.summary("selection");
    for (json const& each : summary.at("findings"))
      if (each.at("code") == "integration_step") severities.push_back(each.at("severity"));
    return severities;
  };
  CHECK(selected("1") == std::vector<std::string>{"error"});
  CHECK(selected("32").empty());
}
