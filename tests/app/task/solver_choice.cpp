// The solver of a fit with draws: chosen by its modes, chosen again where the draws need a finer one.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "app/running.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

struct Decay {
  RunResult run;
  json fit;
};

// Eight samples of a decay that is over between two of them, in noise that leaves its rate open up to where one step of rk4 is
// wrong.
std::string decay_text(std::uint64_t seed, std::string const& options) {
  return R"(
model lag {
  state y
  initial y = 1
  parameter k ~ log_uniform(0.05, 2.6)
  y' = -k*y
  observe level ~ normal(y, sd = 0.2)
}
data record { file "results/truth/made.csv"; time t [s]; measure level = level }
truth = simulate lag with values(k = 0.9), noise = model, samples = 8, rate = 1 [Hz], substeps = 40, seed = )" +
         std::to_string(seed) + R"(, file = "made.csv"
posterior = fit lag to record with mh(samples = 6000, burn_in = 2000, thin = 2))" +
         options + ", seed = 1\n";
}

Decay run_decay(std::uint64_t seed, std::string const& options = "") {
  std::string const text = decay_text(seed, options);
  TemporaryFolder folder;
  RunOptions options_of_run;
  options_of_run.output = folder.path() / "results";
  Decay decay{run_text(folder.path() / "lag.sysid", text, options_of_run), {}};
  decay.fit = json::parse(read_file(options_of_run.output / "posterior/summary.json"));
  return decay;
}

/// Counts jobs of the back end, and interrupts a job of the choice of the solver after it at one of its reports.
class AtSecondChoice : public Progress {
 public:
  explicit AtSecondChoice(int report) : report_(report) {}
  void begin(std::string_view what, std::uint64_t) override {
    sampled += what == "sampling" ? 1 : 0;
    choosing_ = sampled == 1 && what.starts_with("trying");
  }
  void advance(std::uint64_t, std::string_view) override {
    if (choosing_ && ++reports == report_) request_interrupt();
  }
  void end(bool) override {}

  int sampled = 0, reports = 0;

 private:
  int report_;
  bool choosing_ = false;
};

bool has_finding(json const& summary, std::string const& code) {
  for (json const& finding : summary.at("findings"))
    if (finding.at("code") == code) return true;
  return false;
}

}  // namespace

TEST_CASE("a step that suits the mode but not the draws is chosen again, and the fit is sampled with it") {
  Decay const again = run_decay(1);
  CHECK(again.run.exit == 0);
  CHECK(again.run.notices.find("sampling again with a finer solver") != std::string::npos);
  CHECK(again.fit.at("settings").at("substeps") == 2);
  CHECK_FALSE(has_finding(again.fit, "integration_step"));
  // The draws are those of a fit that states the finer step.
  Decay const stated = run_decay(1, ", substeps = 2");
  CHECK(stated.fit.at("parameters").at("k").at("ess_bulk").get<double>() > 400);
  CHECK(again.fit.at("parameters").at("k").at("mean").get<double>() ==
        doctest::Approx(stated.fit.at("parameters").at("k").at("mean").get<double>()).epsilon(0.05));
  // One that states the coarse one keeps it, and fails.
  Decay const coarse = run_decay(1, ", substeps = 1");
  CHECK(coarse.run.exit == 1);
  CHECK(has_finding(coarse.fit, "integration_step"));
}

TEST_CASE("a step that suits mode and draws is not chosen again") {
  Decay const once = run_decay(2);
  CHECK(once.run.exit == 0);
  CHECK(once.run.notices.find("sampling again") == std::string::npos);
  CHECK(once.fit.at("settings").at("substeps") == 1);
}

TEST_CASE("a fit that is interrupted while its step is chosen again goes on from there, to the same bytes") {
  TemporaryFolder folder;
  RunOptions options;
  auto const run = [&](char const* output, std::vector<std::string> const& verbs, AtSecondChoice& progress) {
    options.output = folder.path() / output;
    int const exit = run_text(folder.path() / "lag.sysid", decay_text(1, ""), options, verbs, &progress).exit;
    clear_interrupt();
    return exit;
  };
  AtSecondChoice unbroken(0);
  run("results", {"simulate"}, unbroken);
  REQUIRE(run("results", {"fit"}, unbroken) == 0);
  REQUIRE(unbroken.sampled == 2);
  REQUIRE(unbroken.reports > 2);
  for (int const report : {1, unbroken.reports / 2, unbroken.reports}) {
    CAPTURE(report);
    options = {};
    AtSecondChoice broken(report);
    std::string const output = std::to_string(report);
    REQUIRE(run(output.c_str(), {"fit"}, broken) == 75);
    CHECK_FALSE(std::filesystem::exists(options.output / "posterior/summary.json"));
    options.resume = true;
    AtSecondChoice rest(0);
    CHECK(run(output.c_str(), {"fit"}, rest) == 0);
    CHECK(rest.sampled == 1);  // with the solver that was chosen again alone
    for (char const* file : {"summary.json", "draws_1.csv"})
      CHECK(read_file(options.output / "posterior" / file) == read_file(folder.path() / "results/posterior" / file));
  }
}
