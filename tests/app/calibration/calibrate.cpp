// A calibration from the text to its folder: what it writes, that nothing but plan and seed decides its bytes, what it refuses.
#include "app/calibration/calibrate.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "app/comparison/compare.hpp"
#include "app/run/report_results.hpp"
#include "app/running.hpp"
#include "calibrating.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

std::string const model = R"(model line {
  input     u
  parameter slope ~ normal(0, sd = 10)
  parameter sigma ~ log_uniform(0.01, 1)
  observe d ~ normal(slope*u, sd = sigma)
}
data bench {
  file    "bench.csv"
  input   u = u
  measure d = d
  split   train = rows 3..20
}
)";

std::string const fit = "posterior = fit line to bench.train with mh(samples = 800, burn_in = 200, thin = 1), seed = 4\n";

/// A desk with the record, whose fourth sample is missing.
struct CalibrationDesk {
  TemporaryFolder folder;
  RunOptions options;

  CalibrationDesk() {
    std::string csv = "u,d\n";
    for (int i = 0; i < 25; ++i) csv += std::to_string(0.1 * i) + (i == 3 ? ",\n" : "," + std::to_string(0.2 * i) + "\n");
    write_file(folder.path() / "bench.csv", csv);
    options.output = folder.path() / "results";
    options.execution.threads = 1;
  }
  CalibrateResult run(std::string const& text, int replications = 20, std::string const& task = {}) const {
    CalibrateOptions calibrate;
    calibrate.replications = replications;
    calibrate.task = task;
    return calibrate_text(folder.path() / "case.sysid", text, options, calibrate);
  }
  std::string file(std::string const& name) const { return read_file(options.output / name); }
  std::string refusal(std::string const& text, std::string const& task = {}, int replications = 20) const {
    try {
      run(text, replications, task);
    } catch (UserError const& error) {
      return error.diagnostic().message;
    }
    return "";
  }
};

}  // namespace

TEST_CASE("a calibration writes a result that can be reported again, with a rank of each quantity and record") {
  CalibrationDesk const desk;
  CalibrateResult const result = desk.run(model + fit);
  CHECK(result.exit == 0);
  CHECK(result.out.find("verdict: ") != std::string::npos);
  json const summary = json::parse(desk.file("posterior/summary.json"));
  CHECK(summary.at("verb") == "calibrate");
  CHECK(summary.at("settings").at("replications") == 20);
  json const& calibration = summary.at("calibration");
  CHECK(calibration.at("with_draws") == 20);
  CHECK(calibration.at("quantities").size() == 3);
  CHECK(calibration.at("quantities").at("log likelihood").at("adjusted_p").get<double>() > 0.001);
  CHECK(summary.at("data").at(0).at("scored") == 18);
  std::string const ranks = desk.file("posterior/ranks.csv");
  CHECK(std::count(ranks.begin(), ranks.end(), '\n') > 20);
  CHECK(ranks.find("slope_true,slope_rank,slope_below,slope_mean,slope_sd") != std::string::npos);
  std::string const page = desk.file("posterior/report.html");
  CHECK(page.find("sysid calibrate ") != std::string::npos);
  report_results(desk.options.output / "posterior", desk.folder.path() / "again.html", false);
  CHECK(read_file(desk.folder.path() / "again.html") == page);
  CHECK_THROWS_AS(compare({desk.options.output}), UserError);
}

TEST_CASE("the bytes of a calibration depend neither on threads nor on interruptions") {
  CalibrationDesk once, twice, stopped;
  CHECK(once.run(model + fit).exit == 0);
  twice.options.execution.threads = 2;
  CHECK(twice.run(model + fit).exit == 0);
  for (std::uint64_t const after : {3, 4, 5}) {
    stopped.options.interrupt_after = after;
    CHECK(stopped.run(model + fit).exit == 75);
    clear_interrupt();
    stopped.options.resume = true;
  }
  stopped.options.interrupt_after = 0;
  CalibrateResult const resumed = stopped.run(model + fit);
  CHECK(resumed.exit == 0);
  CHECK(resumed.notices.find("continuing after 12 of 20 replications") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(stopped.options.output / "posterior/checkpoint.cbor"));
  for (CalibrationDesk const* other : {&twice, &stopped})
    CHECK(other->file("posterior/ranks.csv") == once.file("posterior/ranks.csv"));
  auto const numbers = [](CalibrationDesk const& desk) {
    return json::parse(desk.file("posterior/summary.json")).at("calibration");
  };
  CHECK(numbers(twice) == numbers(once));
  CHECK(numbers(stopped) == numbers(once));
  CHECK(stopped.run(model + fit).notices.find("complete, kept") != std::string::npos);
  // More replications go on from those that there are.
  CHECK(stopped.run(model + fit, 30).notices.find("continuing after 20 of 30 replications") != std::string::npos);
  CalibrationDesk whole;
  whole.run(model + fit, 30);
  CHECK(stopped.file("posterior/ranks.csv") == whole.file("posterior/ranks.csv"));
  CHECK_THROWS_AS(whole.run(model + fit, 30), UserError);
}

TEST_CASE("a finished result that is not this calibration is never overwritten without --force") {
  CalibrationDesk desk;
  CHECK(desk.run(model + fit).exit == 0);
  std::string const ranks = desk.file("posterior/ranks.csv");
  desk.options.resume = true;
  CHECK(desk.refusal(model + fit, {}, 10).find("has 20 replications, more than 10") != std::string::npos);
  CHECK(desk.file("posterior/ranks.csv") == ranks);
  desk.options.seed = 5;
  CHECK(desk.refusal(model + fit, {}, 30).find("were computed with another seed") != std::string::npos);
  CHECK(desk.file("posterior/ranks.csv") == ranks);
}

TEST_CASE("a calibration whose seed was drawn goes on with that seed") {
  CalibrationDesk desk;
  std::string const drawn = with(fit, ", seed = 4", "");
  CHECK(desk.run(model + drawn, 10).exit != 75);
  auto const seed = [&] { return json::parse(desk.file("posterior/summary.json")).at("seed").get<std::uint64_t>(); };
  std::uint64_t const first = seed();
  desk.options.resume = true;
  CHECK(desk.run(model + drawn, 12).notices.find("continuing after 10 of 12 replications") != std::string::npos);
  CHECK(seed() == first);
}

TEST_CASE("a fit does not take the result or the checkpoint of a calibration for its own") {
  CalibrationDesk desk;
  auto const run = [&] { return run_text(desk.folder.path() / "case.sysid", model + fit, desk.options); };
  desk.options.resume = true;
  desk.options.interrupt_after = 3;
  CHECK(desk.run(model + fit).exit == 75);
  clear_interrupt();
  desk.options.interrupt_after = 0;
  CHECK_THROWS_AS(run(), UserError);
  CHECK(desk.run(model + fit).exit == 0);
  CHECK_THROWS_AS(run(), UserError);
  CHECK(json::parse(desk.file("posterior/summary.json")).at("verb") == "calibrate");
}

TEST_CASE("a checkpoint of a calibration that has been changed is refused") {
  CalibrationDesk desk;
  desk.options.interrupt_after = 3;
  CHECK(desk.run(model + fit).exit == 75);
  clear_interrupt();
  desk.options.interrupt_after = 0;
  desk.options.resume = true;
  auto const path = desk.options.output / "posterior/checkpoint.cbor";
  std::string bytes = read_file(path);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_file(path, bytes);
  CHECK(desk.refusal(model + fit).find("is damaged") != std::string::npos);
}

TEST_CASE("what cannot be calibrated is refused with the reason") {
  CalibrationDesk const desk;
  CHECK(desk.refusal(model + fit, "posteriro") ==
        "there is no fit task `posteriro` in " + (desk.folder.path() / "case.sysid").string());
  CHECK(desk.refusal(model).starts_with("there is no fit task in "));
  std::string const improper = with(model, "slope ~ normal(0, sd = 10)", "slope ~ flat()");
  CHECK(desk.refusal(improper + fit).find("needs proper priors") != std::string::npos);
  std::string const few = with(fit, "samples = 800", "samples = 224");
  CHECK(desk.refusal(model + few).find("it keeps 96 draws") != std::string::npos);
  // Overflows wherever the parameter is not tiny.
  std::string const wild = with(model, "slope*u", "exp(exp(abs(100*slope)))*u");
  CHECK(desk.refusal(wild + fit).find("of its prior cannot be simulated") != std::string::npos);
}

TEST_CASE("a row that one experiment scores and another looks back to is refused") {
  CalibrationDesk const desk;
  std::string const looks_back = R"(model line {
  time discrete 1 [s]
  input     u
  parameter slope ~ normal(0, sd = 0.5)
  parameter sigma ~ log_uniform(0.01, 1)
  observe d ~ normal(slope*lag(measured(d), 1) + u, sd = sigma)
}
data bench {
  file    "bench.csv"
  step    1 [s]
  input   u = u
  measure d = d
  split   first = rows 6..14, second = rows 15..25, third = rows 16..25
}
)";
  auto const of = [](std::string const& part) { return with(fit, "bench.train", "bench.first, bench." + part); };
  CHECK(desk.refusal(looks_back + of("second")).find("`bench.second` reads row 14 without scoring it") != std::string::npos);
  CHECK(desk.refusal(looks_back + of("third"), {}, 10).empty());
}

TEST_CASE("optima are calibrated by the normal distribution that their sd stands for") {
  CalibrationDesk const desk;
  std::string const known = with(model, "parameter sigma ~ log_uniform(0.01, 1)", "parameter sigma = 0.1");
  CHECK(desk.run(known + with(fit, "mh(samples = 800, burn_in = 200, thin = 1)", "map"), 100).exit == 0);
  json const slope = json::parse(desk.file("posterior/summary.json")).at("calibration").at("quantities").at("slope");
  CHECK(slope.at("coverage_90").get<double>() == doctest::Approx(0.9).epsilon(0.12));
}
