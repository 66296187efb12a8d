// Averages over fits of whole files: weights as `compare` has them, bands, the parts of their variance, scores, and what stands
// between.
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "app/comparison/compare.hpp"
#include "app/running.hpp"
#include "app/tables.hpp"
#include "core/numeric/random.hpp"
#include "core/text/diagnostic.hpp"
#include "relative.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

/// y = 0.5 + x + bend x^2 + noise of 0.3, 24 rows of training and 60 more.
std::string rows(double bend) {
  Stream stream({11, Purpose::test, 0, 0});
  std::string text = "x,y\n";
  for (int i = 0; i < 84; ++i) {
    double const x = 4 * stream.uniform() - 2;
    text += fmt::format("{},{}\n", x, 0.5 + x + bend * x * x + 0.3 * stream.normal());
  }
  return text;
}

std::string const models = R"(
model line {
  input x
  parameter a ~ normal(0, sd = 2)
  parameter b ~ normal(0, sd = 2)
  parameter sigma ~ log_uniform(0.05, 5)
  observe y ~ normal(a + b*x, sd = sigma)
  derive slope = b
}
model parabola {
  input x
  parameter a ~ normal(0, sd = 2)
  parameter b ~ normal(0, sd = 2)
  parameter c ~ normal(0, sd = 2)
  parameter sigma ~ log_uniform(0.05, 5)
  observe y ~ normal(a + b*x + c*x^2, sd = sigma)
}
data table { file "table.csv"; input x = x; measure y = y; split train = rows 1..24, test = rows 25..84 }
straight = fit line to table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 1
curved = fit parabola to table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 2
)";

std::vector<std::pair<std::string, std::string>> const files = {{"table.csv", rows(0.12)}};

json const& member(json const& summary, std::string const& fit) {
  for (json const& each : summary.at("average").at("members"))
    if (each.at("fit") == fit) return each;
  throw std::out_of_range(fit);
}

json finding(json const& summary, std::string const& code) {
  for (json const& each : summary.at("findings"))
    if (each.at("code") == code) return each;
  return nullptr;
}

std::string refusal(std::string const& text) {
  try {
    CaseRun const run(text, files);
  } catch (UserError const& error) {
    return error.diagnostic().code;
  }
  return "";
}

}  // namespace

TEST_CASE("an average has the weights of compare, the law of total variance at each row, and scores beside its members'") {
  CaseRun const run(models + R"(
alone = predict curved on table.test with draws(300), seed = 5
both = predict curved, straight on table.test with draws(300), seed = 5
stacked = predict curved, straight on table.test with draws(300), weights = stacking, seed = 5
)",
                    files);
  json const summary = run.summary("both"), alone = run.summary("alone");
  auto const results = run.folder.path() / "results";
  Comparison const comparison = compare({results / "curved", results / "straight"});
  CHECK(member(summary, "curved").at("weight").get<double>() == relative(*comparison.fits[0].probability, 1e-12));
  CHECK(member(summary, "straight").at("weight").get<double>() == doctest::Approx(*comparison.fits[1].probability));
  CHECK(member(run.summary("stacked"), "straight").at("weight").get<double>() ==
        relative(comparison.scores.fits[1].stacking, 1e-9));
  double const w = member(summary, "straight").at("weight").get<double>();
  CHECK(w > 0.01);  // else the average shows nothing
  CHECK(w < 0.99);
  std::string const csv = run.file("both/predict.csv");
  auto const parameter = column(csv, "y_parameter_variance"), model = column(csv, "y_model_variance"),
             noise = column(csv, "y_noise_variance"), sd = column(csv, "y_noisy_sd"), response = column(csv, "y_sd"),
             mean = column(csv, "y_mean"), lower = column(csv, "y_noisy_q2.5"), upper = column(csv, "y_noisy_q97.5");
  REQUIRE(parameter.size() == 84);
  for (std::size_t i = 0; i < 84; ++i) {
    CHECK(sd[i] * sd[i] == relative(parameter[i] + model[i] + noise[i], 1e-9));
    CHECK(response[i] * response[i] == relative(parameter[i] + model[i], 1e-9));
    CHECK(parameter[i] > 0);
    CHECK(noise[i] > 0.04);  // sigma is about 0.3
    CHECK(lower[i] < mean[i]);
    CHECK(upper[i] > mean[i]);
  }
  // Quantities that only one model has are not averaged.
  CHECK(csv.find("slope") == std::string::npos);
  json const& scores = summary.at("average").at("scores").at("table.test").at("y");
  CHECK(scores.at("samples") == 60);
  // The first member's draws are those of its prediction alone.
  CHECK(scores.at("members").at("curved").at("rmse").get<double>() ==
        doctest::Approx(alone.at("fit").at("rmse").get<double>()).epsilon(1e-9));
  CHECK(scores.at("average").at("rmse").get<double>() == doctest::Approx(summary.at("fit").at("rmse").get<double>()));
  for (char const* name : {"curved", "straight"})
    CHECK(scores.at("average").at("log_score").get<double>() >= scores.at("members").at(name).at("log_score").get<double>() +
                                                                    std::log(member(summary, name).at("weight").get<double>()) -
                                                                    1e-12);
  json const& shares = summary.at("average").at("variance").at("table.test").at("y");
  CHECK(shares.at("parameter").get<double>() + shares.at("model").get<double>() + shares.at("noise").get<double>() ==
        doctest::Approx(1));
  CHECK(finding(summary, "averaged_over_models").at("message").get<std::string>().starts_with("weights by evidence: "));
  CHECK(run.result.out.find("Average and its members: y on table.test, 60 samples") != std::string::npos);
}

TEST_CASE("log scores are those of the stored draws, computed apart") {
  CaseRun const run(models + "both = predict curved, straight on table.test with draws(100000), weights = equal, seed = 5\n",
                    files);
  auto const x = column(files.front().second, "x"), y = column(files.front().second, "y");
  // [members][rows]: the mean density over all stored draws, since `draws` asks for no fewer.
  std::vector<std::vector<double>> densities(2, std::vector<double>(60, 0));
  for (int k = 0; k < 2; ++k) {
    std::string const fit = k == 0 ? "curved" : "straight";
    int draws = 0;
    for (int chain = 1; chain <= 4; ++chain) {
      std::string const text = run.file(fmt::format("{}/draws_{}.csv", fit, chain));
      auto const a = column(text, "a"), b = column(text, "b"), sigma = column(text, "sigma");
      auto const c = k == 0 ? column(text, "c") : std::vector<double>(a.size(), 0);
      draws += static_cast<int>(a.size());
      for (std::size_t d = 0; d < a.size(); ++d)
        for (std::size_t i = 0; i < 60; ++i) {
          double const z = (y[24 + i] - a[d] - b[d] * x[24 + i] - c[d] * x[24 + i] * x[24 + i]) / sigma[d];
          densities[static_cast<std::size_t>(k)][i] += std::exp(-0.5 * z * z) / sigma[d] / std::sqrt(2 * std::acos(-1.0));
        }
    }
    for (double& each : densities[static_cast<std::size_t>(k)]) each /= draws;
  }
  double one = 0, other = 0, both = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    one += std::log(densities[0][i]) / 60;
    other += std::log(densities[1][i]) / 60;
    both += std::log((densities[0][i] + densities[1][i]) / 2) / 60;
  }
  json const scores = run.summary("both").at("average").at("scores").at("table.test").at("y");
  CHECK(scores.at("members").at("curved").at("log_score").get<double>() == doctest::Approx(one).epsilon(1e-5));
  CHECK(scores.at("members").at("straight").at("log_score").get<double>() == doctest::Approx(other).epsilon(1e-5));
  CHECK(scores.at("average").at("log_score").get<double>() == doctest::Approx(both).epsilon(1e-5));
}

TEST_CASE("a fit of the same model counts once, and an average of one model is its prediction") {
  CaseRun const run(models + R"(
again = fit line to table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 3
one = predict straight on table.test with draws(200), seed = 4
two = predict straight, again on table.test with draws(200), weights = stacking, seed = 4
)",
                    files);
  json const summary = run.summary("two");
  CHECK(member(summary, "straight").at("weight") == 1);
  CHECK(member(summary, "again").at("weight") == 0);
  CHECK(member(summary, "again").at("counted_with") == "straight");
  CHECK_FALSE(finding(summary, "counted_once").is_null());
  for (char const* name : {"y_mean", "y_q2.5", "y_q97.5", "y_noisy_q2.5", "y_noisy_q97.5"}) {
    auto const alone = column(run.file("one/predict.csv"), name), averaged = column(run.file("two/predict.csv"), name);
    REQUIRE(alone.size() == averaged.size());
    for (std::size_t i = 0; i < alone.size(); ++i) CHECK(averaged[i] == relative(alone[i], 1e-9));
  }
}

TEST_CASE("units of the members differ and the average is in one") {
  std::string text = R"(
model metres { input x; parameter a [m] ~ normal(0, sd = 3); observe y [m] ~ normal(a + x*1[m], sd = 0.3 [m]) }
model centimetres { input x; parameter a [cm] ~ normal(0, sd = 300); observe y [cm] ~ normal(a + x*100 [cm], sd = 30 [cm]) }
data table { file "table.csv"; input x = x; measure y = y [m]; split train = rows 1..24, test = rows 25..84 }
one = fit metres to table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 1
other = fit centimetres to table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 2
both = predict one, other on table.test with draws(300), weights = equal, seed = 5
)";
  CaseRun const run(text, files);
  json const scores = run.summary("both").at("average").at("scores").at("table.test").at("y");
  double const one = scores.at("members").at("one").at("log_score"), other = scores.at("members").at("other").at("log_score");
  CHECK(other == doctest::Approx(one).epsilon(0.02));  // one model in two units
  CHECK(scores.at("members").at("other").at("rmse").get<double>() ==
        doctest::Approx(scores.at("members").at("one").at("rmse").get<double>()).epsilon(0.02));
}

TEST_CASE("temperatures with different zero points are averaged as one quantity") {
  CaseRun const run(R"(
model celsius { input x; parameter a [degC] ~ normal(0, sd = 3); observe y [degC] ~ normal(a + x*1 [delta_degC], sd = 0.3 [K])
  derive shown [degC] = a + x*1 [delta_degC] }
model kelvin { input x; parameter a [K] ~ normal(273.15, sd = 3); observe y [K] ~ normal(a + x*1 [K], sd = 0.3 [K])
  derive shown [K] = a + x*1 [K] }
data table { file "table.csv"; input x = x; measure y = y [degC]; split train = rows 1..24, test = rows 25..84 }
one = fit celsius to table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 1
other = fit kelvin to table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 2
both = predict one, other on table.test with draws(300), weights = equal, seed = 5
)",
                    files);
  json const scores = run.summary("both").at("average").at("scores").at("table.test").at("y");
  double const rmse = scores.at("members").at("one").at("rmse");
  CHECK(scores.at("members").at("other").at("rmse").get<double>() == doctest::Approx(rmse).epsilon(0.02));
  CHECK(scores.at("average").at("rmse").get<double>() == doctest::Approx(rmse).epsilon(0.02));
  std::string const csv = run.file("both/predict.csv");
  for (char const* const name : {"y_mean", "y_noisy_q97.5", "shown_q97.5"})
    for (double const value : column(csv, name)) CHECK(std::fabs(value) < 10);  // [degC]
  CHECK(refusal(R"(
model celsius { input x; parameter a [degC] ~ normal(0, sd = 3); observe y [degC] ~ normal(a + x*1 [delta_degC], sd = 0.3 [K]) }
model risen { input x; parameter a [delta_degC] ~ normal(0, sd = 3)
  observe y [delta_degC] ~ normal(a + x*1 [delta_degC], sd = 0.3 [K]) }
data table { file "table.csv"; input x = x; measure y = y; split train = rows 1..24, test = rows 25..84 }
one = fit celsius to table.train with mh(samples = 30, burn_in = 5, chains = 2), seed = 1
other = fit risen to table.train with mh(samples = 30, burn_in = 5, chains = 2), seed = 2
both = predict one, other on table.test with draws(10), weights = equal, seed = 5
)") == "E6706");
}

TEST_CASE("models that look back by different numbers of rows are averaged on the rows that both predict") {
  std::string text = R"(
model one_back { time discrete 1 [s]; parameter p ~ normal(0, sd = 1); parameter s ~ log_uniform(0.05, 5)
  observe y ~ normal(p*lag(measured(y), 1), sd = s) }
model two_back { time discrete 1 [s]; parameter p ~ normal(0, sd = 1); parameter q ~ normal(0, sd = 1); parameter s ~ log_uniform(0.05, 5)
  observe y ~ normal(p*lag(measured(y), 1) + q*lag(measured(y), 2), sd = s) }
data series { file "table.csv"; step 1 [s]; measure y = y; split train = rows 3..40, test = rows 41..84 }
one = fit one_back to series.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 1
two = fit two_back to series.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 2
rest = predict one, two on series.test with draws(200), seed = 5
whole = predict two, one on series with draws(200), seed = 5
)";
  CaseRun const run(text, files);
  CHECK(run.summary("rest").at("average").at("scores").at("series.test").at("y").at("samples") == 44);
  CHECK(run.summary("whole").at("average").at("scores").at("series").at("y").at("samples") == 82);
}

TEST_CASE("an average needs results of all its fits, and a result of other samples is refused") {
  std::string const task = "both = predict curved, straight on table.test with draws(50), seed = 5\n";
  TemporaryFolder const folder;
  write_file(folder.path() / "table.csv", files.front().second);
  RunOptions options;
  options.output = folder.path() / "results";
  auto const run = [&](std::string const& text, std::vector<std::string> const& verbs) {
    try {
      return std::to_string(run_text(folder.path() / "case.sysid", text, options, verbs).exit);
    } catch (UserError const& error) {
      return error.diagnostic().code;
    }
  };
  CHECK(run(models + task, {"predict"}) == "E6202");
  CHECK(run(models + task, {"fit"}) == "0");
  CHECK(run(models + task, {"predict"}) == "0");
  json const before = json::parse(read_file(options.output / "both/summary.json"));
  CHECK(before.at("versions").at("made_from") == "curved");
  CHECK(before.at("versions").at("made_from_2") == "straight");
  CHECK(compare({options.output / "both"}).notes.empty());
  // The fits are run again, one of them otherwise: the average is one of earlier results.
  std::string const again = with(models, "chains = 4), seed = 2", "chains = 4), seed = 9");
  REQUIRE(again != models);
  write_file(folder.path() / "again.sysid", again);
  options.force = true;
  run_text(folder.path() / "again.sysid", again, options, {"fit"});
  auto const notes = compare({options.output / "both"}).notes;
  REQUIRE(notes.size() == 1);
  CAPTURE(notes.front());
  CHECK(notes.front().find("was made from an earlier run of `curved`") != std::string::npos);
  CHECK(refusal(with(models, "straight = fit line to table.train", "straight = fit line to table") + task) == "E6705");
  CHECK(refusal(with(models, "straight = fit line to table.train", "straight = fit line to table") +
                with(task, "draws(50)", "draws(50), weights = equal")) == "");
}

TEST_CASE("what is wrong with one fit is said with its name") {
  CaseRun const run(
      with(models, "curved = fit parabola to table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4)",
           "curved = fit parabola to table.train with mh(samples = 30, burn_in = 10, thin = 1, chains = 2)") +
          "both = predict curved, straight on table with draws(50), seed = 5\n",
      files);
  json const summary = run.summary("both");
  json const doubtful = finding(summary, "from_doubtful_fit");
  REQUIRE_FALSE(doubtful.is_null());
  CHECK(doubtful.at("severity") == "error");
  CHECK(doubtful.at("names").at(0) == "curved");
  CHECK(summary.at("verdict").at("pass") == false);
  CHECK(finding(summary, "fitted_rows_predicted").at("message").get<std::string>().find("`curved` was fitted to") !=
        std::string::npos);
}

TEST_CASE("the bands of a selection have the parts of parameters and models, which sum to their variance") {
  CaseRun const run(models + R"(
candidates both { line; parabola }
selection = select both to table.train with abc_smc(particles = 200, populations = 3), seed = 1
forecast = predict selection on table.test with draws(200), seed = 1
)",
                    files);
  std::string const csv = run.file("forecast/predict.csv");
  auto const sd = column(csv, "y_sd"), parameter = column(csv, "y_parameter_variance"), model = column(csv, "y_model_variance");
  REQUIRE(sd.size() == 84);
  for (std::size_t i = 0; i < sd.size(); ++i) CHECK(parameter[i] + model[i] == relative(sd[i] * sd[i], 1e-9));
  CHECK(*std::ranges::max_element(model) > 0);
  CHECK(csv.find("y_noise_variance") == std::string::npos);
}

TEST_CASE("units of other names are one unit") {
  for (auto const& [one, other] : std::vector<std::pair<std::string, std::string>>{{"Hz", "1/s"}, {"", ""}}) {
    auto const in = [](std::string const& unit) { return unit.empty() ? std::string() : " [" + unit + "]"; };
    auto const number = [](std::string const& unit) { return unit.empty() ? "1" : "1 [" + unit + "]"; };
    std::string const noise = one.empty() ? "0.3" : "0.3 [Hz]", sd = one.empty() ? "exp(a*0)" : "1";
    std::string const text =
        fmt::format(R"(
model first {{ input x; parameter a{0} ~ normal(0, sd = 3); observe y{0} ~ normal(a + x*{2}, sd = {4}) }}
model second {{ input x; parameter a{1} ~ normal(0, sd = 3); observe y{1} ~ normal({6}, sd = {4}) }}
data table {{ file "table.csv"; input x = x; measure y = y{0}; split train = rows 1..24, test = rows 25..84 }}
one = fit first to table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 1
other = fit second to table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 2
both = predict other, one on table.test with draws(100), weights = equal, seed = 5
)",
                    in(one), in(other), number(one), number(other), noise, sd, one.empty() ? "exp(a*x)" : "a + x*1 [1/s]");
    CAPTURE(text);
    CaseRun const run(text, files);
    CHECK(run.summary("both").at("average").at("scores").at("table.test").at("y").at("samples") == 60);
  }
  CHECK(refusal(R"(
model plain { input x; parameter a ~ normal(0, sd = 3); observe y ~ normal(a + x, sd = 0.3) }
model metres { input x; parameter a [m] ~ normal(0, sd = 3); observe y [m] ~ normal(a + x*1[m], sd = 0.3 [m]) }
data table { file "table.csv"; input x = x; measure y = y; split train = rows 1..24, test = rows 25..84 }
one = fit plain to table.train with mh(samples = 30, burn_in = 5, chains = 2), seed = 1
other = fit metres to table.train with mh(samples = 30, burn_in = 5, chains = 2), seed = 2
both = predict one, other on table.test with draws(10), weights = equal, seed = 5
)") != "");
}

namespace {

/// y is undefined in the second model below x = -0.9, where the first 15 rows of the file lie, which are predicted.
std::string undefined_rows() {
  Stream stream({12, Purpose::test, 0, 0});
  std::string text = "x,y\n";
  for (int i = 0; i < 60; ++i) {
    double const x = i < 15 ? -2 + i / 15.0 : -0.8 + (i - 15) / 20.0;
    text += fmt::format("{},{}\n", x, 0.5 + x + 0.3 * stream.normal());
  }
  return text;
}

std::string const undefined = R"(
model line { input x; parameter a ~ normal(0, sd = 2); parameter b ~ normal(0, sd = 2); observe y ~ normal(a + b*x, sd = 0.3) }
model root { input x; parameter a ~ normal(0, sd = 2); parameter b ~ normal(0, sd = 2); observe y ~ normal(a + b*log(0.9 + x), sd = 0.3) }
data table { file "table.csv"; input x = x; measure y = y; split test = rows 1..30, train = rows 31..60 }
straight = fit line to table.train with mh(samples = 2000, burn_in = 500, thin = 5, chains = 4), seed = 1
bent = fit root to table.train with mh(samples = 2000, burn_in = 500, thin = 5, chains = 4), seed = 1
)";

}  // namespace

TEST_CASE("samples that a fit says are impossible count against it, and rows that it cannot predict are named") {
  CaseRun const run(undefined + "both = predict straight, bent on table.test with draws(100), weights = equal, seed = 5\n",
                    {{"table.csv", undefined_rows()}});
  json const summary = run.summary("both"), scores = summary.at("average").at("scores").at("table.test").at("y");
  CHECK(scores.at("samples") == 30);
  CHECK(scores.at("members").at("bent").at("log_score").is_null());  // -infinity
  CHECK(scores.at("average").at("log_score").is_number());
  CHECK(scores.at("average").at("log_score").get<double>() >=
        scores.at("members").at("straight").at("log_score").get<double>() + std::log(0.5) - 1e-12);
  json const undefined_rows = finding(summary, "undefined_in_band");
  REQUIRE_FALSE(undefined_rows.is_null());
  CHECK(undefined_rows.at("severity") == "error");
  CHECK(undefined_rows.at("message").get<std::string>().find("`bent`: y is undefined along every trajectory at 15 of 30 rows") !=
        std::string::npos);
}

TEST_CASE("a fit of no weight blanks nothing") {
  // The rows where its model has no value are fitted by the other alone: it counts with the first fit of the same model.
  CaseRun const run(with(undefined, "bent = fit root",
                         "again = fit line to table.train with mh(samples = 40, burn_in = 10, chains = 2), "
                         "seed = 3\nbent = fit root") +
                        "both = predict straight, again on table.test with draws(100), weights = stacking, seed = 5\n",
                    {{"table.csv", undefined_rows()}});
  json const summary = run.summary("both");
  CHECK(member(summary, "again").at("counted_with") == "straight");
  for (json const& each : summary.at("findings")) {
    CAPTURE(each.dump());
    CHECK(each.at("severity") == "note");
  }
  json const doubtful = finding(summary, "from_doubtful_fit");
  REQUIRE_FALSE(doubtful.is_null());
  CHECK(doubtful.at("names").at(0) == "again");
  CHECK(summary.at("verdict").at("pass") == true);
}

TEST_CASE("the noisy band of optima holds the noise") {
  CaseRun const run(
      with(with(models, "straight = fit line to table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4)",
                "straight = fit line to table.train with map"),
           "curved = fit parabola to table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4)",
           "curved = fit parabola to table.train with map") +
          "both = predict curved, straight on table.test with weights = equal, seed = 5\n",
      files);
  json const summary = run.summary("both"), scores = summary.at("average").at("scores").at("table.test").at("y");
  CHECK(scores.at("average").at("coverage_95").get<double>() > 0.85);
  CHECK(scores.at("members").at("curved").at("coverage_95").get<double>() > 0.85);
  CHECK(finding(summary, "coverage_low").is_null());
  std::string const csv = run.file("both/predict.csv");
  auto const noise = column(csv, "y_noise_variance"), lower = column(csv, "y_noisy_q2.5"), upper = column(csv, "y_noisy_q97.5");
  for (std::size_t i = 0; i < noise.size(); ++i) CHECK(upper[i] - lower[i] > 2.5 * std::sqrt(noise[i]));
}

TEST_CASE("noise without a variance has no shares") {
  CaseRun const run(R"(
model heavy { input x; parameter a ~ normal(0, sd = 3); observe y ~ student_t(a + x, 1.5, scale = 0.3) }
model light { input x; parameter a ~ normal(0, sd = 3); observe y ~ normal(a + x, sd = 0.3) }
data table { file "table.csv"; input x = x; measure y = y; split train = rows 1..24, test = rows 25..84 }
one = fit heavy to table.train with mh(samples = 2000, burn_in = 500, thin = 5, chains = 4), seed = 1
other = fit light to table.train with mh(samples = 2000, burn_in = 500, thin = 5, chains = 4), seed = 2
both = predict one, other on table.test with draws(100), weights = equal, seed = 5
)",
                    files);
  json const shares = run.summary("both").at("average").at("variance").at("table.test").at("y");
  for (char const* name : {"sd", "parameter", "model", "noise"}) CHECK(shares.at(name).is_null());
  CHECK(run.file("both/report.html").find("no finite variance") != std::string::npos);
}

TEST_CASE("fits name the same samples in any order") {
  std::string const tasks = R"(
data other { file "table.csv"; input x = x; measure y = y; split train = rows 25..44 }
straight = fit line to table.train, other.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 1
curved = fit parabola to other.train, table.train with mh(samples = 3000, burn_in = 500, thin = 5, chains = 4), seed = 2
both = predict curved, straight on table.test with draws(50), seed = 5
stacked = predict curved, straight on table.test with draws(50), weights = stacking, seed = 5
)";
  CHECK(refusal(models.substr(0, models.find("straight = fit")) + tasks) == "");
}

TEST_CASE("an average of one-step predictions and free runs is of neither kind") {
  CaseRun const run(R"(
model one_back { time discrete 1 [s]; parameter p ~ normal(0, sd = 1); parameter s ~ log_uniform(0.05, 5)
  observe y ~ normal(p*lag(measured(y), 1), sd = s) }
model free { time discrete 1 [s]; state v
  initial v = 0
  parameter m ~ normal(0, sd = 1); parameter p ~ uniform(-1, 1); parameter s ~ log_uniform(0.05, 5)
  v = m + p*lag(v, 1)
  observe y ~ normal(v, sd = s) }
data series { file "table.csv"; step 1 [s]; measure y = y; split train = rows 6..40, test = rows 41..84 }
one = fit one_back to series.train with mh(samples = 2000, burn_in = 500, thin = 5, chains = 4), seed = 1
run = fit free to series.train with mh(samples = 2000, burn_in = 500, thin = 5, chains = 4), seed = 2
alone = predict run on series.test with draws(50), seed = 5
mixed = predict one, run on series.test with draws(50), weights = equal, seed = 5
whole = predict one, run on series with draws(50), weights = equal, seed = 5
)",
                    files);
  CHECK(run.summary("mixed").at("prediction_rule") == "mixed");
  bool said = false;
  json const summary = run.summary("mixed");
  for (json const& each : summary.at("findings"))
    said = said || each.at("message").get<std::string>().starts_with("predictions of two kinds are averaged");
  CHECK(said);
  // The model that looks back scores one row less.
  CHECK(run.summary("whole").at("data").at(0).at("scored") == 83);
  auto const results = run.folder.path() / "results";
  for (auto const& each : compare({results / "alone", results / "mixed"}).predictions)
    CHECK(each.kind == (each.name == "mixed" ? "mixed" : "free run"));
}
