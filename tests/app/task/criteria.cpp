// Predictive scores of whole fits: leave-future-out against refits of the shorter records, what each kind of fit has, and fits
// compared by them.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "app/comparison/compare.hpp"
#include "app/running.hpp"
#include "core/numeric/random.hpp"
#include "core/numeric/statistics.hpp"
#include "criteria/leave_out.hpp"
#include "replications.hpp"
#include "report/file/number_table.hpp"
#include "report/page/comparison.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

constexpr int rows = 60;

double normal_log_density(double y, double mean, double sd) {
  return -std::log(sd) - 0.5 * std::log(2 * std::numbers::pi) - 0.5 * (y - mean) * (y - mean) / (sd * sd);
}

/// A record with what a model says of each of its rows, so that a test can compute densities itself.
struct Case {
  std::string model;
  std::vector<double> y;
  std::function<double(std::map<std::string, double> const& draw, int row)> log_density;  // row from 0
  int first_scored = 0;

  std::string csv() const {
    std::string text = "t,y\n";
    for (int i = 0; i < rows; ++i) text += fmt::format("{},{}\n", 0.5 * i, y[static_cast<std::size_t>(i)]);
    return text;
  }
};

Case autoregression(std::uint64_t seed) {
  Case out;
  out.model = R"(
model process {
  time discrete 0.5 [s]
  parameter a ~ normal(0, sd = 1)
  parameter c ~ normal(0, sd = 2)
  parameter sigma ~ log_uniform(0.01, 10)
  observe y ~ normal(c + a*lag(measured(y), 1), sd = sigma)
}
)";
  Stream stream({seed, Purpose::test, 0, 0});
  double last = 1;
  for (int i = 0; i < rows; ++i) out.y.push_back(last = 0.4 + 0.6 * last + 0.5 * stream.normal());
  out.log_density = [y = out.y](auto const& draw, int row) {
    auto const i = static_cast<std::size_t>(row);
    return normal_log_density(y[i], draw.at("c") + draw.at("a") * y[i - 1], draw.at("sigma"));
  };
  out.first_scored = 1;
  return out;
}

Case decay(std::uint64_t seed) {
  Case out;
  out.model = R"(
model process {
  state y [-]
  parameter rate [1/s] ~ log_uniform(0.01, 1)
  parameter y0 ~ normal(3, sd = 2)
  parameter rest ~ normal(0, sd = 1)
  parameter sigma ~ log_uniform(0.01, 10)
  y' = rate*(rest - y)
  initial y = y0
  observe y ~ normal(y, sd = sigma)
}
)";
  Stream stream({seed, Purpose::test, 1, 0});
  for (int i = 0; i < rows; ++i) out.y.push_back(0.5 + 2.5 * std::exp(-0.1 * 0.5 * i) + 0.2 * stream.normal());
  out.log_density = [y = out.y](auto const& draw, int row) {
    double const rest = draw.at("rest"), at = rest + (draw.at("y0") - rest) * std::exp(-draw.at("rate") * 0.5 * row);
    return normal_log_density(y[static_cast<std::size_t>(row)], at, draw.at("sigma"));
  };
  return out;
}

struct Estimate {
  double sum = 0, variance = 0;
};

/// Log densities of rows [first, last) under the draws of a task that was fitted to those before.
Estimate predicted(CaseRun const& run, std::string const& task, Case const& of, int first, int last) {
  std::vector<std::map<std::string, double>> draws;
  constexpr int chains = 4;
  for (int c = 1; c <= chains; ++c) {
    NumberTable const table = read_number_table(run.folder.path() / "results" / task / fmt::format("draws_{}.csv", c));
    for (std::size_t d = 0; d < table.rows(); ++d) {
      draws.emplace_back();
      for (std::size_t n = 0; n < table.names.size(); ++n) draws.back()[table.names[n]] = table.columns[n][d];
    }
  }
  Estimate out;
  DrawInfluence influence(draws.size());
  for (int row = first; row < last; ++row) {
    std::vector<double> log_density, density;
    for (auto const& draw : draws) {
      log_density.push_back(of.log_density(draw, row));
      density.push_back(std::exp(log_density.back()));
    }
    LeftOut const equal{std::vector<double>(draws.size(), -std::log(static_cast<double>(draws.size()))), 0,
                        relative_efficiency(density, chains)};
    double const each = log_mean(equal.log_weights, log_density);
    influence.add(equal, log_density, each);
    out.sum += each;
  }
  out.variance = influence.error() * influence.error();
  return out;
}

struct Deviation {
  double in_errors;  // score by weights minus that by refits, in their common error
  int blocks;        // that have a score
};

Deviation deviation_from_refits(Case const& of, std::uint64_t seed) {
  int const scored = rows - of.first_scored;
  std::string text = of.model + "data d { file \"points.csv\"; time t [s]; measure y = y; split all = rows 1..60";
  std::vector<int> ends;  // indices of rows
  for (int b = 5; b <= 10; ++b) ends.push_back(of.first_scored + scored * b / 10);
  for (int b = 0; b < 5; ++b) text += fmt::format(", before_{} = rows 1..{}", b, ends[static_cast<std::size_t>(b)]);
  text += fmt::format(" }}\nwhole = fit process to d.all with mh, seed = {}\n", seed);
  for (int b = 0; b < 5; ++b)
    text += fmt::format("refit_{0} = fit process to d.before_{0} with mh(samples = 6000, burn_in = 2000, thin = 4), seed = {1}\n",
                        b, seed + 1);
  CaseRun const run(text, {{"points.csv", of.csv()}});
  CAPTURE(run.result.notices);
  json const criteria = run.summary("whole").at("criteria"), found = criteria.at("leave_future_out");
  CAPTURE(found.dump(1));
  if (found.is_null()) return {0, 0};
  int const first_row = found.at("records").at(0).at("first_row");
  auto const first = static_cast<std::size_t>(std::ranges::find(ends, first_row - 1) - ends.begin());
  REQUIRE(first < 5);
  CHECK(found.at("samples") == rows - ends[first]);
  CHECK(found.at("records").at(0).at("last_row") == rows);
  CHECK(found.at("records").at(0).at("pareto_k").size() == 5 - first);
  Estimate refits;
  for (std::size_t b = first; b < 5; ++b) {
    Estimate const one = predicted(run, fmt::format("refit_{}", b), of, ends[b], ends[b + 1]);
    refits.sum += one.sum;
    refits.variance += one.variance;
  }
  double const error = std::hypot(found.at("monte_carlo_error").get<double>(), std::sqrt(refits.variance));
  double const difference = found.at("elpd").get<double>() - refits.sum;
  CAPTURE(refits.sum);
  CAPTURE(error);
  CHECK(error < 1);
  CHECK(std::fabs(difference) < 4 * error);
  return {difference / error, static_cast<int>(5 - first)};
}

}  // namespace

// A full run takes as many of each kind of record as docs/methods/criteria.md reports.
TEST_CASE("leave-future-out equals refits of the shorter records within its error, on two kinds of record") {
  int const records = replications(1, 20);
  for (auto* const kind : {&autoregression, &decay}) {
    CAPTURE(kind == &decay);
    std::vector<double> deviations;
    int blocks = 0;
    for (int r = 1; r <= records; ++r) {
      CAPTURE(r);
      auto const seed = static_cast<std::uint64_t>(10 * r);
      Deviation const each = deviation_from_refits(kind(seed), seed);
      if (each.blocks > 0) deviations.push_back(each.in_errors);
      blocks += each.blocks;
    }
    double const size = std::sqrt(squared_deviations(deviations, 0) / static_cast<double>(deviations.size()));
    MESSAGE("leave-future-out against refits, in their common error: rms ", size, " of ", records, " with ", blocks, " blocks");
    CHECK(blocks >= (records < 10 ? 0.4 : 0.8) * 5 * records);
    if (records >= 10) CHECK(size < 1.6);
  }
}

TEST_CASE("each kind of fit has the scores that it can have, and says why not the others") {
  CaseRun const run(autoregression(1).model + R"(
model still { parameter m ~ normal(0, sd = 5); parameter sigma ~ log_uniform(0.01, 10); observe y ~ normal(m, sd = sigma) }
model drawn {
  input t
  parameter s ~ half_normal(sd = 2)
  parameter l ~ log_normal(median = 5, sd = 1)
  parameter sigma ~ log_uniform(0.01, 10)
  function f(t) ~ gp(squared_exponential(amplitude = s, length = l))
  observe y ~ normal(f(t), sd = sigma)
}
data d { file "points.csv"; time t [s]; measure y = y; split all = rows 1..60 }
data free { file "points.csv"; measure y = y; split all = rows 1..60 }
data along { file "points.csv"; input t = t; measure y = y; split all = rows 1..60 }
a_mh = fit process to d.all with mh(samples = 2000, burn_in = 1000), seed = 1
b_map = fit process to d.all with map, seed = 1
c_ml = fit process to d.all with ml, seed = 1
d_still = fit still to free.all with mh(samples = 2000, burn_in = 1000), seed = 1
e_drawn = fit drawn to along.all with map, seed = 1
)",
                    {{"points.csv", autoregression(1).csv()}});
  CAPTURE(run.result.notices);
  json const mh = run.summary("a_mh").at("criteria"), map = run.summary("b_map").at("criteria"),
             ml = run.summary("c_ml").at("criteria"), still = run.summary("d_still").at("criteria"),
             drawn = run.summary("e_drawn").at("criteria");
  CHECK(mh.at("in_time") == true);
  CHECK(mh.at("loo").at("samples") == 59);
  CHECK(mh.at("dic").at("p_d").get<double>() == doctest::Approx(3).epsilon(0.3));
  CHECK(mh.at("dic").at("p_v").get<double>() == doctest::Approx(3).epsilon(0.3));
  CHECK(mh.at("waic").at("p").get<double>() == doctest::Approx(3).epsilon(0.4));
  CHECK(mh.at("loo").at("elpd").get<double>() == doctest::Approx(mh.at("waic").at("elpd").get<double>()).epsilon(0.01));
  CHECK(mh.at("leave_block_out").at("samples") == 59);
  CHECK(still.at("in_time") == false);
  CHECK_FALSE(still.contains("leave_future_out"));
  for (json const& optimum : {map, ml}) {
    CHECK(optimum.at("reason") == "the fit has no posterior draws");
    CHECK_FALSE(optimum.contains("dic"));
    CHECK_FALSE(optimum.contains("loo"));
    double const deviance = -2 * optimum.at("log_likelihood").get<double>();
    CHECK(optimum.at("aic").get<double>() == doctest::Approx(deviance + 6));
    CHECK(optimum.at("bic").get<double>() == doctest::Approx(deviance + 3 * std::log(59)));
  }
  CHECK(ml.at("at") == "maximum of the likelihood");
  CHECK(map.at("at") == "mode of the posterior");
  CHECK(ml.at("aic").get<double>() <= map.at("aic").get<double>());
  CHECK(drawn.at("reason").get<std::string>().find("Gaussian process") != std::string::npos);
  CHECK_FALSE(drawn.contains("aic"));
  CHECK(run.file("a_mh/report.html").find("Leave-block-out predicts each tenth") != std::string::npos);
  CHECK(run.file("d_still/report.html").find("Leave-block-out") == std::string::npos);
}

TEST_CASE("fits with draws are weighed by what they say of samples that they have not seen") {
  CaseRun const run(autoregression(2).model + R"(
model still { time discrete 0.5 [s]; parameter m ~ normal(0, sd = 5); parameter sigma ~ log_uniform(0.01, 10); observe y ~ normal(m, sd = sigma) }
data d { file "points.csv"; time t [s]; measure y = y; split all = rows 2..60 }
a_process = fit process to d.all with mh(samples = 4000, burn_in = 1000, thin = 2), seed = 1
b_still = fit still to d.all with mh(samples = 4000, burn_in = 1000, thin = 2), seed = 1
c_map = fit process to d.all with map, seed = 1
)",
                    {{"points.csv", autoregression(2).csv()}});
  CAPTURE(run.result.notices);
  Comparison const found = compare({run.folder.path() / "results"});
  REQUIRE(found.scores.fits.size() == 2);
  CHECK(found.scores.future);
  ComparedScore const &process = found.scores.fits[0], &still = found.scores.fits[1];
  CHECK(found.scores.samples == run.summary("a_process").at("criteria").at("leave_future_out").at("samples").get<int>());
  CHECK(process.elpd == doctest::Approx(run.summary("a_process").at("criteria").at("leave_future_out").at("elpd").get<double>()));
  CHECK(process.difference == 0);
  CHECK(still.difference == doctest::Approx(still.elpd - process.elpd));
  CHECK(still.difference_error > 0);
  CHECK(process.stacking + still.stacking == doctest::Approx(1));
  CHECK(process.pseudo_bma > 0.5);
  std::string const text = comparison_text(found);
  CAPTURE(text);
  CHECK(text.find("leave-future-out") != std::string::npos);
  CHECK(json::parse(comparison_json(found)).at("scores").at("fits").size() == 2);
}

TEST_CASE("samples of several channels and experiments are paired whatever order models declare channels in") {
  std::string one = "t,y,z\n", two = one;
  Stream stream({4, Purpose::test, 0, 0});
  for (int i = 0; i < 30; ++i) {
    std::string const z = i == 7 ? "" : fmt::format("{}", -2 + 0.1 * stream.normal());
    one += fmt::format("{},{},{}\n", i, 1 + 0.5 * stream.normal(), z);
    two += fmt::format("{},{},{}\n", i, 1 + 0.5 * stream.normal(), -2 + 0.1 * stream.normal());
  }
  std::string const body =
                        "parameter m ~ normal(0, sd = 5); parameter n ~ normal(0, sd = 5); parameter s ~ log_uniform(0.01, 10); "
                        "parameter r ~ log_uniform(0.01, 10); ",
                    y = "observe y ~ normal(m, sd = s); ", z = "observe z ~ normal(n, sd = r) ",
                    z_first = "observe z ~ normal(n, sd = r); ";
  CaseRun const run(
      "model forth { " + body + y + z + "}\nmodel back { " + body + z_first + "observe y ~ normal(m, sd = s) }\n" + R"(
data a { file "one.csv"; measure y = y; measure z = z; split all = rows 1..30 }
data b { file "two.csv"; measure y = y; measure z = z; split all = rows 1..30 }
a_forth = fit forth to a.all, b.all with mh(samples = 4000, burn_in = 1000, thin = 2), seed = 1
b_back = fit back to a.all, b.all with mh(samples = 4000, burn_in = 1000, thin = 2), seed = 2
)",
      {{"one.csv", one}, {"two.csv", two}});
  CAPTURE(run.result.notices);
  for (char const* const task : {"a_forth", "b_back"}) CHECK(run.summary(task).at("criteria").at("loo").at("samples") == 119);
  Comparison const found = compare({run.folder.path() / "results"});
  REQUIRE(found.scores.fits.size() == 2);
  CHECK(found.scores.left_out.empty());
  CHECK(found.scores.samples == 119);
  // The models are the same, so no sample tells them apart; paired by numbers, y would stand against z.
  CHECK(std::fabs(found.scores.fits[0].difference - found.scores.fits[1].difference) < 0.5);
  for (ComparedScore const& each : found.scores.fits) CHECK(each.difference_error < 0.5);
}
