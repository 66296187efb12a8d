// The density of a fit as a function: that it is the fit's own, and which fits have none.
#include "app/density/fit_density.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

#include "app/running.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

std::string const decay = R"(
model decay {
  state y [m]
  initial y = 1 [m]
  parameter rate  [1/s] ~ log_uniform(0.1, 10)
  parameter noise [m]   ~ log_uniform(1e-3, 1)
  y' = -rate*y
  observe d ~ normal(y, sd = noise)
}
data bench { file "bench.csv"; time t [s]; measure d = d [m] }
posterior = fit decay to bench with mh(samples = 200, burn_in = 100, thin = 1, chains = 2), seed = 1
)";

std::string decay_record() {
  std::string text = "t,d\n";
  for (int i = 0; i < 30; ++i) text += fmt::format("{},{}\n", 0.05 * i, std::exp(-1.3 * 0.05 * i) + 0.02 * std::cos(23.0 * i));
  return text;
}

/// A text in a folder of its own with a session of it.
struct Opened {
  TemporaryFolder folder;
  Source source;
  std::optional<CheckedFile> file;
  RunOptions options;
  SilentProgress progress;
  std::ostringstream out, notices;
  std::unique_ptr<Session> session;

  Opened(std::string const& text, std::string const& name, std::string const& record)
      : source((folder.path() / "case.sysid").string(), text) {
    write_file(folder.path() / name, record);
    Diagnostics diagnostics;
    file = load(source, diagnostics);
    REQUIRE_MESSAGE(file, render(diagnostics, source));
    session = std::make_unique<Session>(source, *file, options, progress, out, notices);
  }
};

std::string code_of(std::function<void()> const& work) {
  try {
    work();
  } catch (UserError const& error) {
    return error.diagnostic().code;
  }
  return "";
}

std::vector<double> likelihood(FitDensity const& density, LaneArray const& declared) {
  LaneArray theta(declared.rows(), declared.width());
  density.target().unconstrain(declared, theta);
  std::vector<double> out(static_cast<std::size_t>(declared.width()));
  Ledger ledger;
  density.target().log_likelihood(theta, out, ledger);
  return out;
}

}  // namespace

TEST_CASE("the density is that of the fit, with its priors, its modes and the solver that it chooses") {
  Opened const opened(decay, "bench.csv", decay_record());
  FitDensity density(*opened.session, 0);
  REQUIRE(density.target().dimension() == 2);
  CHECK(density.priors()[0].text == "log_uniform(0.1, 10)");
  CHECK(density.priors()[1].name == "noise");
  CHECK(density.modes().empty());
  CHECK(density.integrated());
  CHECK(density.prepare(1));
  REQUIRE(density.modes().size() == 1);
  CaseRun const run(decay, {{"bench.csv", decay_record()}});
  auto const summary = run.summary("posterior");
  auto const& mode = summary.at("modes").at(0);
  CHECK(density.modes()[0].log_density == mode.at("log_density").get<double>());
  CHECK(density.modes()[0].declared[0] == mode.at("values").at("rate").get<double>());
  std::vector<double> prior(1), value(1);
  LaneArray theta(2, 1);
  for (int p = 0; p < 2; ++p) theta(p, 0) = density.modes()[0].theta[static_cast<std::size_t>(p)];
  Ledger ledger;
  density.target().log_prior(theta, prior);
  density.target().log_likelihood(theta, value, ledger);
  CHECK(prior[0] + value[0] == density.modes()[0].log_density);
}

TEST_CASE("simulations follow the equations, and their noise the seed") {
  Opened const opened(decay, "bench.csv", decay_record());
  FitDensity const density(*opened.session, 0);
  LaneArray values(2, 2);
  for (int w = 0; w < 2; ++w) values(0, w) = 1 + w, values(1, w) = 0.1;
  auto const made = density.simulate(0, values, 1), same = density.simulate(0, values, 1), other = density.simulate(0, values, 2);
  CHECK(made.experiment == "bench");
  REQUIRE(made.quantities.at(0).name == "d");
  for (std::size_t i = 0; i < made.time.size(); ++i)
    CHECK(made.result.values[0][1][i] == relative(std::exp(-2 * made.time[i]), 1e-5));
  CHECK(made.result.noisy[0] == same.result.noisy[0]);
  CHECK(made.result.noisy[0] != other.result.noisy[0]);
}

TEST_CASE("each lane depends on its own values alone") {
  Opened const opened(decay, "bench.csv", decay_record());
  FitDensity const density(*opened.session, 0);
  LaneArray many(2, 37);
  for (int w = 0; w < 37; ++w) many(0, w) = 0.5 + 0.1 * w, many(1, w) = 0.05;
  std::vector<double> const together = likelihood(density, many);
  for (int w : {0, 5, 36}) {
    LaneArray one(2, 1);
    for (int p = 0; p < 2; ++p) one(p, 0) = many(p, w);
    CHECK(likelihood(density, one)[0] == together[static_cast<std::size_t>(w)]);
  }
}

TEST_CASE("an estimated likelihood is no function, and neither is a prediction that depends on the data") {
  std::string const random = R"(
model relaxing {
  state x
  initial x ~ normal(0, sd = 1)
  parameter a [1/s] ~ log_uniform(0.05, 20)
  disturbance w [1/s] ~ white(intensity = 0.5 [1/s])
  x' = -a*x + w
  observe m ~ normal(x, sd = 0.3)
}
data d { file "d.csv"; time t [s]; measure m = m }
cloud = fit relaxing to d with mh, filter = particle, solver = exponential, seed = 1
)";
  Opened const particles(random, "d.csv", "t,m\n0,0.1\n0.25,0.3\n0.5,-0.2\n0.75,0\n1,0.1\n");
  CHECK(code_of([&] { FitDensity(*particles.session, 0); }) == "E6212");
  std::string const process = R"(
model line {
  input u
  parameter s     ~ half_normal(sd = 5)
  parameter lu    ~ log_normal(median = 1, sd = 1)
  parameter sigma ~ log_uniform(0.01, 10)
  function f(u) ~ gp(squared_exponential(amplitude = s, length = lu))
  observe d ~ normal(f(u), sd = sigma)
}
data bench { file "bench.csv"; input u = u; measure d = d }
posterior = fit line to bench with map, seed = 1
)";
  Opened const processes(process, "bench.csv", "u,d\n0,0.1\n1,0.9\n2,2.1\n3,3\n4,3.9\n");
  FitDensity const density(*processes.session, 0);
  LaneArray values(3, 1);
  for (int p = 0; p < 3; ++p) values(p, 0) = 1;
  CHECK(std::isfinite(likelihood(density, values)[0]));
  CHECK(code_of([&] { density.simulate(0, values, 1); }) == "E6212");
}
