// What a run says of a point estimate: what its numbers are, whether its solver is accurate enough for them, and what a prediction
// from it leaves out.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "app/running.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

std::filesystem::path const duffing = std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing/duffing.sysid";

// Duffing's oscillator by `map` with the options given, on the shipped record.
std::string optimum_of(std::string const& options) {
  std::string const text = read_file(duffing);
  return with(text, "with mh(samples = 25000, burn_in = 5000, thin = 10, chains = 4)", "with map" + options);
}

struct Told {
  RunResult run;
  json fit, forecast;
};

Told run_optimum(std::string const& text) {
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  Told told{run_text(duffing, text, options, {"fit", "predict"}), {}, {}};
  told.fit = json::parse(read_file(options.output / "posterior/summary.json"));
  told.forecast = json::parse(read_file(options.output / "forecast/summary.json"));
  return told;
}

int times_in(std::string const& text, std::string const& part) {
  int found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

bool found(json const& summary, std::string const& code) {
  for (json const& finding : summary.at("findings"))
    if (finding.at("code") == code) return true;
  return false;
}

}  // namespace

TEST_CASE("an optimum is called one, has no quantiles, and what is predicted from it says what it leaves out") {
  Told const told = run_optimum(optimum_of(""));
  CHECK(told.run.exit == 0);
  CHECK(told.run.out.find("optimum, a single point") != std::string::npos);
  CHECK(told.run.out.find("Laplace sd") != std::string::npos);
  CHECK(told.run.out.find("q95") == std::string::npos);
  json const& k = told.fit.at("parameters").at("k");
  CHECK(k.at("mean").get<double>() == doctest::Approx(1e4).epsilon(0.01));
  CHECK(k.at("sd").get<double>() > 0);
  CHECK(k.at("q5").is_null());
  CHECK(told.fit.at("parameters").at("fn").at("q5").is_null());
  CHECK(found(told.forecast, "optimum_alone"));
  CHECK_FALSE(found(told.fit, "integration_step"));
}

TEST_CASE("a stated tolerance too loose for the data is an error, a tight one is not") {
  // Two swings between samples, known to 1e-5: errors of 1e-5 a step add up to more.
  std::string const text = R"(
model swing {
  state y [m]; initial y = 1 [m], y' = 0
  parameter k ~ log_uniform(140, 160)
  parameter c ~ log_uniform(0.05, 0.2)
  parameter sigma [m] ~ log_uniform(1e-7, 1e-2)
  y'' + c*y' + k*y = 0
  observe position ~ normal(y, sd = sigma)
}
data record { file "results/truth/swing.csv"; time t [s]; measure position = position [m] }
truth = simulate swing with values(k = 150, c = 0.1, sigma = 1e-5), noise = model, samples = 25, rate = 1 [Hz], solver = dopri5(relative = 1e-12), seed = 1, file = "swing.csv"
tight = fit swing to record with map, solver = dopri5(relative = 1e-11), seed = 1
loose = fit swing to record with map, solver = dopri5(relative = 1e-5), search = near(tight), seed = 1
)";
  CaseRun const run(text, {});
  CHECK_FALSE(found(run.summary("tight"), "integration_step"));
  CHECK(found(run.summary("loose"), "integration_step"));
}

TEST_CASE("an integrator that is part of the model is reported; one that is not fails") {
  auto const severity_of = [](Told const& told) {
    for (json const& finding : told.fit.at("findings"))
      if (finding.at("code") == "integration_step") return finding.at("severity").get<std::string>();
    return std::string("none");
  };
  Told const declared = run_optimum(optimum_of(", solver = euler(substeps = 1, as_model = yes)"));
  CHECK(declared.run.exit == 0);
  CHECK(severity_of(declared) == "note");
  CHECK(declared.fit.at("settings").at("as_model") == true);
  Told const stated = run_optimum(optimum_of(", solver = euler(substeps = 1)"));
  CHECK(stated.run.exit == 1);
  CHECK(severity_of(stated) == "error");
  CHECK_FALSE(stated.fit.at("settings").contains("as_model"));
  // Without a statement the guard still chooses.
  Told const chosen = run_optimum(optimum_of(", solver = heun(as_model = no)"));
  CHECK(severity_of(chosen) == "none");
  CHECK(chosen.fit.at("settings").at("substeps") == 8);
}

TEST_CASE("a solver that has spent its steps is advised more of them, and no other method") {
  Told const spent = run_optimum(optimum_of(", solver = dopri5(steps = 1)"));
  CHECK(spent.run.exit == 1);
  for (json const& finding : spent.fit.at("findings"))
    if (finding.at("code") == "step_not_settled") {
      CHECK(finding.at("help").get<std::string>().find("`steps`, now 1") != std::string::npos);
      CHECK(finding.at("help").get<std::string>().find("cvode") == std::string::npos);
    }
  CHECK(found(spent.fit, "step_not_settled"));
}

TEST_CASE("a parameter that nothing uses is said once, and the direction it leaves flat by its name") {
  std::string const text = with(optimum_of(""), "  parameter c ", "  parameter idle ~ normal(0, sd = 1)\n  parameter c ");
  std::string const used = text.substr(0, text.find("\ntruth")) + text.substr(text.find("\nposterior"));
  // The density of `log_uniform` is largest at its lower bound: another one lies there.
  Told const told = run_optimum(with(used, "  parameter c ", "  parameter spare ~ log_uniform(0.1, 10)\n  parameter c "));
  CHECK(found(told.fit, "unused_parameter"));
  CHECK_FALSE(found(told.fit, "at_bound"));
  CHECK(times_in(told.run.out, "idle is used in no equation") == 1);
  // Its prior has a width: the posterior has one, too.
  CHECK_FALSE(found(told.fit, "flat_direction"));
  std::string const likeliest = with(used, "with map", "with ml");
  Told const flat = run_optimum(likeliest);
  CHECK(times_in(flat.run.out, "the data do not determine idle") == 1);
}
