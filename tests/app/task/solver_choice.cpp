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
Decay run_decay(std::uint64_t seed, std::string const& options = "") {
  std::string const text = R"(
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
  TemporaryFolder folder;
  RunOptions options_of_run;
  options_of_run.output = folder.path() / "results";
  Decay decay{run_text(folder.path() / "lag.sysid", text, options_of_run), {}};
  decay.fit = json::parse(read_file(options_of_run.output / "posterior/summary.json"));
  return decay;
}

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
