// Results side by side: probabilities from evidences, predictions by their rows, and what is refused.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/comparison/compare.hpp"
#include "app/run/report_results.hpp"
#include "app/running.hpp"
#include "core/numeric/random.hpp"
#include "core/text/diagnostic.hpp"
#include "relative.hpp"
#include "report/file/stored_files.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

std::string compared_record() {
  Stream stream({.seed = 7, .purpose = Purpose::test, .index = 0, .step = 0});
  std::ostringstream text;
  text << "t,x,y\n";
  double y = 0;
  for (int i = 0; i < 120; ++i) {
    double const x = stream.normal();
    text << 0.5 * i << "," << x << "," << y << "\n";
    y = 0.6 * y + x + 0.1 * stream.normal();
  }
  return text.str();
}

std::string const models = R"(
model still {
  time discrete 0.5 [s]
  input x
  parameter b ~ normal(0, sd = 2)
  parameter sigma ~ log_uniform(0.01, 10)
  observe y ~ normal(b*lag(x, 1), sd = sigma)
}
model arx {
  time discrete 0.5 [s]
  input x
  parameter a ~ normal(0, sd = 2)
  parameter b ~ normal(0, sd = 2)
  parameter sigma ~ log_uniform(0.01, 10)
  observe y ~ normal(a*lag(measured(y), 1) + b*lag(x, 1), sd = sigma)
}
model longer {
  time discrete 0.5 [s]
  input x
  parameter a ~ normal(0, sd = 2)
  parameter c ~ normal(0, sd = 2)
  parameter b ~ normal(0, sd = 2)
  parameter sigma ~ log_uniform(0.01, 10)
  observe y ~ normal(a*lag(measured(y), 1) + c*lag(measured(y), 3) + b*lag(x, 1), sd = sigma)
}
data points { file "points.csv"; time t [s]; input x = x; measure y = y; split train = rows 5..80, head = rows 1..80, test = rows 81..120 }
)";

CaseRun runs(std::string const& tasks) { return CaseRun(models + tasks, {{"points.csv", compared_record()}}); }

}  // namespace

TEST_CASE("models are weighed by their evidence, each once, and predictions stand with those of the same rows") {
  CaseRun const run = runs(R"(
a_still = fit still to points.train with map, seed = 1
b_arx = fit arx to points.train with map, seed = 1
c_again = fit arx to points.train with map, seed = 2
d_ml = fit longer to points.train with ml, seed = 1
one = predict b_arx on points.test with draws(20), seed = 1
other = predict b_arx on points.train with draws(20), seed = 1
free = predict b_arx on points.test with draws(20), prediction = free_run, seed = 1
)");
  Comparison const found = compare({run.folder.path() / "results"});
  REQUIRE(found.fits.size() == 4);
  CHECK(found.data == "points.train, rows 5..80 (76 scored)");
  auto const log_evidence = [&](char const* task) { return run.summary(task).at("evidence").at("log_evidence").get<double>(); };
  double const odds = std::exp(log_evidence("a_still") - log_evidence("b_arx"));
  CHECK(*found.fits[0].probability == relative(odds / (1 + odds), 1e-12));
  CHECK(*found.fits[1].probability == doctest::Approx(1 / (1 + odds)));
  CHECK(*found.fits[2].probability == *found.fits[1].probability);
  CHECK_FALSE(found.fits[3].probability);
  CHECK(found.fits[1].parameters == 3);
  CHECK(found.fits[1].noise.starts_with("sigma 0."));
  REQUIRE(found.predictions.size() == 3);
  // By name they are free, one, other; free and one are of the same rows.
  CHECK(found.predictions[0].kind == "free run");
  CHECK(found.predictions[1].kind == "one step");
  CHECK(found.predictions[0].samples == found.predictions[1].samples);
  CHECK(found.predictions[2].rows == "5..80");
  CHECK(found.notes.empty());
  CHECK(found.predictions[1].nmse == run.summary("one").at("fit").at("nmse").get<double>());
  std::string const text = comparison_text(found);
  CAPTURE(text);
  CHECK(text.find("`d_ml` has no evidence: only the likelihood") != std::string::npos);
  json const printed = json::parse(comparison_json(found));
  CHECK(printed.at("fits").at(3).at("log_evidence").is_null());
  CHECK(printed.at("predictions").size() == 3);
}

TEST_CASE("results are compared by their fields, whatever their sentences say") {
  CaseRun const run = runs(R"(
a_still = fit still to points.train with map, seed = 1
b_arx = fit arx to points.train with map, seed = 1
c_head = fit longer to points.head with map, seed = 1
free = predict b_arx on points.test with draws(20), prediction = free_run, seed = 1
one = predict b_arx on points.test with draws(20), seed = 1
)");
  auto const results = run.folder.path() / "results";
  char const* const alike[] = {"a_still", "b_arx", "free", "one"};
  auto const compared = [&] {
    std::vector<std::filesystem::path> folders;
    for (char const* task : alike) folders.push_back(results / task);
    return compare(folders);
  };
  auto const refusal = [&](std::filesystem::path const& other) {
    try {
      compare({results / "b_arx", other});
    } catch (UserError const& error) {
      return error.diagnostic().message + "; " + error.diagnostic().help;
    }
    return std::string("not refused");
  };
  auto const rewrite = [&](std::string const& task, auto const& change) {
    json summary = run.summary(task);
    change(summary);
    write_file(results / task / "summary.json", sealed_summary(summary.dump(2)));
  };
  // Predictions hold the digest of the summary that they were made from, which the other words change.
  auto const without_source = [](json& summary) { summary["versions"].erase("made_from"); };
  for (char const* task : {"free", "one"}) rewrite(task, without_source);
  std::string const table = comparison_json(compared()), refused = refusal(results / "c_head");
  CHECK(refused.find("after the longest lag of all models") != std::string::npos);
  CHECK(run.summary("a_still").at("lags") == 1);
  CHECK(run.summary("c_head").at("lags") == 3);
  CHECK(run.summary("free").at("verb") == "predict");
  CHECK(run.summary("free").at("prediction_rule") == "free_run");
  CHECK(run.summary("one").at("prediction_rule") == "as_written");
  CHECK(run.summary("one").at("measured_past") == true);
  for (char const* task : {"a_still", "b_arx", "c_head", "free", "one"})
    rewrite(task, [](json& summary) {
      summary["what"] = "other words";
      if (summary["settings"].contains("prediction")) summary["settings"]["prediction"] = "other words";
      for (json& data : summary["data"]) data["notes"] = {"other words"};
    });
  CHECK(comparison_json(compared()) == table);
  CHECK(refusal(results / "c_head") == refused);

  rewrite("c_head", [](json& summary) { summary["versions"].erase("form"); });
  CHECK(refusal(results / "c_head") == fmt::format("`{}` was written by another version of sysid; run the task again with --force",
                                                   (results / "c_head").string()));
}

TEST_CASE("one model with two inputs for the same samples is weighed as two") {
  CaseRun const run = runs(R"(
data self { file "points.csv"; time t [s]; input x = y; measure y = y; split train = rows 5..80 }
a_input = fit still to points.train with map, seed = 1
b_self = fit still to self.train with map, seed = 1
)");
  Comparison const found = compare({run.folder.path() / "results"});
  REQUIRE(found.fits.size() == 2);
  CHECK(*found.fits[0].probability + *found.fits[1].probability == doctest::Approx(1));
  CHECK((*found.fits[0].probability > *found.fits[1].probability) == (*found.fits[0].log_evidence > *found.fits[1].log_evidence));
  REQUIRE(found.notes.size() == 1);
  CHECK(found.notes[0] == "the fits of `still` differ in the inputs, constants or the rule between samples: a_input; b_self");
  auto const page = run.folder.path() / "page.html";
  report_results(run.folder.path() / "results", page, false);
  CHECK(read_file(page).find("differ in the inputs, constants or the rule between samples: a_input; b_self") != std::string::npos);
}

TEST_CASE("fits to different samples are refused, also where only the models' own lags make the difference") {
  CaseRun const run = runs(R"(
train = fit arx to points.train with map, seed = 1
head = fit arx to points.head with map, seed = 1
long = fit longer to points.head with map, seed = 1
)");
  auto const results = run.folder.path() / "results";
  auto const refusal = [&](char const* one, char const* other) {
    try {
      compare({results / one, results / other});
    } catch (UserError const& error) {
      return error.diagnostic().message + "; " + error.diagnostic().help;
    }
    return std::string("not refused");
  };
  CHECK(refusal("head", "long") ==
        "`head` and `long` are fitted to different samples: points.head, rows 2..80 (79 scored) and points.head, rows 4..80 (77 "
        "scored); "
        "evidences can be compared only for the same samples: begin the fitted rows after the longest lag of all models");
  CHECK(refusal("train", "long").starts_with("`train` and `long` are fitted to different samples"));
  CHECK_THROWS_AS(compare({run.folder.path()}), UserError);  // holds no results itself
  CHECK_THROWS_AS(compare({run.folder.path() / "nowhere"}), IoError);
  CHECK_NOTHROW(compare({results / "head", results / "head"}));
}

TEST_CASE("the number of lags of a process is found by evidence on the same rows") {
  // y(t) from y(t - 1) and y(t - 2); candidates look back one to four samples, and all are fitted to rows 5 to 124.
  int found = 0;
  constexpr int records = 4;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    CAPTURE(seed);
    Stream stream({.seed = seed, .purpose = Purpose::test, .index = 0, .step = 0});
    std::ostringstream text;
    text << "t,y\n";
    double last = 0, before = 0;
    for (int i = 0; i < 124; ++i) {
      double const y = 0.9 * std::sin(last) - 0.5 * before + 0.3 * stream.normal();
      text << 0.25 * i << "," << y << "\n";
      before = last, last = y;
    }
    std::string file = R"(
model narx(n) {
  time discrete 0.25 [s]
  parameter s ~ half_normal(sd = 5)
  parameter l ~ log_normal(median = 3, sd = 1)
  parameter sigma ~ log_uniform(0.001, 10)
  function f(past) ~ gp(squared_exponential(amplitude = s, length = l))
  observe y ~ normal(f(lags(measured(y), 1..n)), sd = sigma)
}
data d { file "points.csv"; time t [s]; measure y = y; split train = rows 5..124 }
)";
    for (int n = 1; n <= 4; ++n) file += fmt::format("lags_{0} = fit narx(n = {0}) to d.train with map, seed = 1\n", n);
    CaseRun const run(file, {{"points.csv", text.str()}});
    Comparison const comparison = compare({run.folder.path() / "results"});
    REQUIRE(comparison.fits.size() == 4);
    CHECK(comparison.data == "d.train, rows 5..124 (120 scored)");
    double best = 0;
    std::string name;
    for (ComparedFit const& fit : comparison.fits)
      if (*fit.probability > best) best = *fit.probability, name = fit.name;
    CHECK(*comparison.fits[0].probability < 0.01);  // one lag is surely too few
    found += name == "lags_2" ? 1 : 0;
  }
  CHECK(found >= records - 1);
}
