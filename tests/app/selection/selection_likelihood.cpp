// The likelihood beside a selection's particles: places that are no modes, climbs that are given up, models with nothing to polish,
// disagreements, and interruptions there.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/selection/likelihood_check.hpp"
#include "app/selection/line.hpp"
#include "relative.hpp"

using namespace sysid;
using json = nlohmann::json;
using testing::Line;
using testing::Printed;
using testing::slope;

namespace {

/// d = |p| t: of two signs, where p < 0 leaves the range of numbers at the quarters of a step of 0.1 s. RK4 with one step a sample
/// reads its ends and its middle, with two steps the quarters as well.
std::string signed_slope(std::string const& name, std::string const& prior) {
  return "model " + name + " { input u; state q; initial q = 0; parameter p ~ " + prior +
         "\nq' = abs(p) + (if p < 1 then 1e-9*sqrt(0.5 - abs(sin(20*pi*u))) else 0); observe d ~ normal(q, sd = 0.1) }\n";
}

/// Most probable by its prior, and far more so by its likelihood.
std::string const line_and_wave =
    "model straight { input u; state q; initial q = 0; parameter k ~ uniform(0, 10); q' = k + 0*u; observe d ~ normal(q, sd = 0.1) "
    "}\n"
    "model wave { input u; state q, v; initial q = 0, v = 0; parameter a ~ uniform(0, 100); parameter w ~ uniform(18, 26)\n"
    "parameter z ~ uniform(0, 0.5); q' = v; v' = -2*z*w*v - w^2*q + a*u; observe d ~ normal(q, sd = 0.1) }\n"
    "candidates both { straight probability 0.8; wave probability 0.2 }\n";

/// Knows whether a line of progress is open, and asks for an interruption in the likelihood's part: when it begins, or when all
/// candidates have been climbed and solvers are settled.
class Watch : public Progress {
 public:
  explicit Watch(bool at_its_beginning) : at_its_beginning_(at_its_beginning) {}
  void begin(std::string_view what, std::uint64_t total) override {
    open = true;
    total_ = total;
    beside_ = what == "computing likelihoods";
    if (beside_ && at_its_beginning_) ask();
  }
  void advance(std::uint64_t done, std::string_view) override {
    if (beside_ && !at_its_beginning_ && done == total_) ask();
  }
  void end(bool finished) override {
    open = false;
    cut_short = cut_short || (beside_ && !finished);
  }
  bool open = false, asked = false, cut_short = false;

 private:
  void ask() {
    asked = true;
    request_interrupt();
  }
  bool at_its_beginning_, beside_ = false;
  std::uint64_t total_ = 0;
};

}  // namespace

TEST_CASE("a place that only a coarse solver reaches is no mode: it takes no part in evidence or chains, and settles at once") {
  Line const line(0.1, 0.0);
  Printed const answer =
      line.run(signed_slope("either", "uniform(-10, 10)") + signed_slope("upward", "uniform(0, 10)") +
               signed_slope("downward", "uniform(-10, 0)") +
               "candidates all { either; upward; downward }\nanswer = select all to line with abc_smc(particles = 300, "
               "populations = 3, polish = yes, polish_samples = 4000), seed = 1");
  // One mode each, and twice the prior density there in the second: evidences 1 to 2. With both signs they would be equal.
  CHECK(answer.model("either").at("laplace").at("probability").get<double>() == doctest::Approx(1.0 / 3).epsilon(1e-3));
  CHECK(answer.model("either").at("laplace").at("solver") == "rk4(substeps = 2)");
  CHECK(answer.model("upward").at("laplace").at("solver") == "rk4(substeps = 1)");
  // All chains start where the likelihood is.
  json const& p = answer.model("either").at("polished").at("p");
  CHECK(p.at("q5").get<double>() > 0);
  CHECK(p.at("mean").get<double>() == doctest::Approx(slope).epsilon(0.02));
  CHECK(p.at("rhat").get<double>() < 1.05);
  // Nothing is left of a model whose only mode is such a place, which is said.
  REQUIRE(answer.model("downward").at("probability").get<double>() > 0.01);
  CHECK_FALSE(answer.model("downward").contains("laplace"));
  CHECK_FALSE(answer.model("downward").contains("polished"));
  CHECK(answer.said("step_not_settled") ==
        "the likelihood of `downward` is not finite at any mode near its particles when the solver is finer than rk4(substeps = "
        "1)\n");
  CHECK(answer.said("not_polished").find("`polish` has no draws of `downward`") == 0);
}

TEST_CASE("nor does such a place hold up a fit") {
  Line const line(0.1, 0.0);
  Printed const answer = line.run(
      signed_slope("either", "uniform(-10, 10)") + "answer = fit either to line with mh(samples = 4000, burn_in = 1000), seed = 1",
      "", {"fit"});
  CHECK(answer.exit == 0);
  CHECK_FALSE(answer.has("step_not_settled"));
  CHECK_FALSE(answer.has("second_mode"));
  CHECK(answer.summary.at("settings").at("substeps") == 2);
  CHECK(answer.summary.at("modes").size() == 1);
  CHECK(answer.summary.at("modes").at(0).at("share") == doctest::Approx(1));
  CHECK(answer.summary.at("parameters").at("p").at("q5").get<double>() > 0);
}

TEST_CASE("a climb that was given up is not followed: no finer solver, no chains, and a word about it") {
  Line const line(0.1, 0.0);
  Printed const answer = line.run(line_and_wave +
                                  "answer = select both to line with abc_smc(particles = 200, populations = 1, polish = yes, "
                                  "polish_samples = 2000), seed = 1");
  REQUIRE(answer.model("wave").at("probability").get<double>() > 0.01);
  REQUIRE(answer.model("wave").at("laplace").contains("given_up"));
  CHECK(answer.model("wave").at("laplace").at("solver") == "rk4(substeps = 1)");
  CHECK(answer.model("straight").contains("polished"));
  CHECK_FALSE(answer.model("wave").contains("polished"));
  CHECK(answer.said("not_polished").find("`polish` has no draws of `wave`: the search for its mode was stopped") == 0);
  CHECK(std::filesystem::exists(line.results() / "answer/polished_straight_1.csv"));
  CHECK_FALSE(std::filesystem::exists(line.results() / "answer/polished_wave_1.csv"));
}

TEST_CASE("an interruption in the likelihood's part closes the line of progress") {
  Line const line(0.1, 0.0);
  std::string const text = line_and_wave + "answer = select both to line with abc_smc(particles = 200, populations = 2), seed = 1";
  for (bool const at_its_beginning : {true, false}) {
    CAPTURE(at_its_beginning);
    Watch watch(at_its_beginning);
    Printed const answer = line.run(text, "", {"select"}, &watch);
    clear_interrupt();
    REQUIRE(watch.asked);
    CHECK(answer.exit == 75);
    CHECK_FALSE(watch.open);
    CHECK(watch.cut_short);
    CHECK(answer.has("interrupted"));
  }
}

TEST_CASE("each model whose probabilities disagree is named, the largest difference first; small ones are not") {
  SelectionResult result;
  auto const add = [&](std::string const& name, double probability, int died_in) {
    result.models.emplace_back();
    result.models.back().name = name;
    result.models.back().probability = probability;
    result.models.back().died_in = died_in;
  };
  add("a", 0.7, 0);
  add("b", 0.05, 0);
  add("c", 0.25, 0);
  add("d", 0, 3);
  add("e", 0, 2);
  add("f", 0, 4);
  Findings const findings = compare_probabilities(result, {0.1, 0.5, 0.24, 0.15, 0.01, std::nullopt});
  REQUIRE(findings.size() == 1);
  CHECK(findings.front().code == FindingCode::probabilities_disagree);
  // 0.15/0.02, 0.6/0.2, 0.45/0.2 of what is tolerable; c differs by 0.01, e is left 0.01 though it died, of f nothing was found.
  CHECK(findings.front().message ==
        "`d` has probability 0.00 by the particles and 0.15 by the likelihood and died in population 3; "
        "`a` has probability 0.70 by the particles and 0.10 by the likelihood; "
        "`b` has probability 0.05 by the particles and 0.50 by the likelihood");
  CHECK(compare_probabilities(result, {0.6, 0.15, 0.24, 0.01, 0.0, 0.0}).empty());
  // What helps depends on where the run has ended.
  auto const advises_a_later_end = [&](double threshold, std::optional<double> floor) {
    result.threshold = threshold;
    return compare_probabilities(result, {0.1, 0.5, 0.24, 0.15, 0.01, std::nullopt}, floor)
        .front()
        .help.starts_with("let the run stop later");
  };
  CHECK(advises_a_later_end(20, std::nullopt));
  CHECK(advises_a_later_end(40, 30));
  CHECK_FALSE(advises_a_later_end(31, 30));
  CHECK_FALSE(advises_a_later_end(20, 30));
}

TEST_CASE("a candidate without parameters has nothing to polish; one whose noise alone is free shows its polished noise") {
  Line const line(0.1, 0.0);
  Printed const answer = line.run(
      "model fixed { input u; parameter k = 2; observe d ~ normal(k*u, sd = 0.1) }\n"
      "model noisy { input u; parameter k = 2; parameter sigma ~ log_uniform(0.01, 1); observe d ~ normal(k*u, sd = sigma) }\n"
      "model free { input u; parameter k ~ uniform(0, 10); observe d ~ normal(k*u, sd = 0.1) }\n"
      "candidates all { fixed; noisy; free }\n"
      "answer = select all to line with abc_smc(particles = 300, populations = 2, polish = yes, polish_samples = 4000), seed = 1");
  REQUIRE(answer.exit == 0);
  CHECK_FALSE(answer.has("not_polished"));
  CHECK_FALSE(answer.model("fixed").contains("polished"));
  CHECK_FALSE(std::filesystem::exists(line.results() / "answer/polished_fixed_1.csv"));
  CHECK(answer.model("fixed").at("laplace").at("probability").get<double>() > 0);
  // The sd of 40 normal samples is known to 1/sqrt(80).
  CHECK(answer.model("noisy").at("polished").at("sigma").at("mean").get<double>() == relative(0.1, 3 / std::sqrt(80.0)));
  CHECK(answer.out.find("parameters of noisy") != std::string::npos);
  CHECK(answer.out.find("parameters of fixed") == std::string::npos);
}

TEST_CASE("candidates that all lack parameters are told apart by distance, and by likelihood, without advice on parameters") {
  Line const line(0.1, 0.0);
  Printed const answer = line.run(
      "model two { input u; parameter k = 2; observe d ~ normal(k*u, sd = 0.1) }\n"
      "model near { input u; parameter k = 2.01; observe d ~ normal(k*u, sd = 0.1) }\n"
      "candidates both { two; near }\n"
      "answer = select both to line with abc_smc(particles = 100, polish = yes), seed = 1\n"
      "forecast = predict answer on line with draws(50), seed = 1",
      "", {"select", "predict"});
  CHECK(answer.exit == 0);
  CHECK_FALSE(answer.has("distances_equal"));
  CHECK_FALSE(answer.has("width_of_threshold"));
  // Sums of squares of the two against the record, which is made here as the fixture makes it.
  double two = 0, near = 0;
  Stream stream({.seed = 11, .purpose = Purpose::test, .index = 0, .step = 0});
  for (int i = 0; i < 40; ++i) {
    double const t = 0.1 * i, y = slope * t + 0.1 * stream.normal();
    two += (y - 2 * t) * (y - 2 * t);
    near += (y - 2.01 * t) * (y - 2.01 * t);
  }
  double const odds = std::exp((near - two) / (2 * 0.1 * 0.1));
  std::string const nearest = two < near ? "two" : "near";
  CHECK(answer.model(nearest).at("probability") == 1);
  CHECK(answer.model("two").at("laplace").at("probability").get<double>() == doctest::Approx(odds / (1 + odds)).epsilon(1e-3));
}

TEST_CASE("a threshold that rests on a candidate without parameters is put down to it") {
  Line const line(0.1, 0.0);  // its least squares are at 1.98648
  Printed const answer = line.run(
      "model fixed { input u; parameter k = 1.9865; observe d ~ normal(k*u, sd = 0.1) }\n"
      "model free { input u; parameter k ~ uniform(0, 10); observe d ~ normal(k*u, sd = 0.1) }\n"
      "candidates both { fixed; free }\nanswer = select both to line with abc_smc(particles = 300), seed = 1");
  CHECK(answer.said("distances_equal").find("all particles of `fixed` have exactly this distance") != std::string::npos);
}
