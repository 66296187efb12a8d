// Records made with functions drawn from their prior: fitted back, and the same twice.
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "app/tables.hpp"

using namespace sysid;

namespace {}  // namespace

TEST_CASE("records made with functions from the prior tell its hyper-parameters") {
  // Four records, each with a function of its own: their estimates scatter about the truth by the widths that they claim.
  std::string text = R"(
model wave {
  input x
  parameter s     ~ log_normal(median = 1, sd = 2)
  parameter l     ~ log_normal(median = 1, sd = 2)
  parameter sigma ~ log_normal(median = 0.3, sd = 2)
  function d(u) ~ gp(matern52(amplitude = s, length = l))
  observe y ~ normal(2*x + d(x), sd = sigma)
}
)";
  for (int i = 1; i <= 4; ++i)
    text += fmt::format(
        "truth{0} = simulate wave with values(s = 1.5, l = 0.8, sigma = 0.2), input x = gaussian(sd = 2), samples = 150, seed = "
        "{0}\n"
        "data made{0} {{ file \"results/truth{0}/truth{0}.csv\"; input x = x; measure y = y }}\n"
        "back{0} = fit wave to made{0} with map, seed = 1\n",
        i);
  CaseRun const run(text, {});
  double sum = 0;
  for (int i = 1; i <= 4; ++i) {
    nlohmann::json const summary = run.summary(fmt::format("back{}", i));
    for (auto const& [name, truth] : {std::pair{"s", 1.5}, std::pair{"l", 0.8}, std::pair{"sigma", 0.2}}) {
      CAPTURE(i);
      CAPTURE(name);
      double const mean = parameter(summary, name).at("mean").get<double>(), sd = parameter(summary, name).at("sd").get<double>();
      double const z = std::log(mean / truth) * mean / sd;
      CHECK(std::fabs(z) < 4);
      sum += z * z;
    }
  }
  // 12 numbers, correlated within a record: 99.9 % of chi squared with 12 degrees of freedom lie below 33.
  CHECK(sum < 33);
  CHECK(sum > 1);
}

TEST_CASE("a function that feeds on its own values, or on noisy samples, is one function along the record") {
  // Fitted one step ahead with known hyper-parameters: were it another function at each sample, its spread would be noise.
  auto const model = [](std::string const& name, std::string const& state, std::string const& centre, std::string const& options) {
    return "model " + name + R"( {
  time discrete 1 [s]
  input x
)" + state +
           R"(
  parameter sigma ~ log_uniform(1e-3, 10)
  function d(before, now) ~ gp(squared_exponential(amplitude = 1, length = 2))
  observe y ~ normal()" +
           centre + ", sd = sigma)\n}\ntruth_" + name + " = simulate " + name +
           " with values(sigma = 0.05), input x = gaussian(sd = 1), samples = 250, seed = 3\ndata made_" + name +
           " { file \"results/truth_" + name + "/truth_" + name + ".csv\"; step 1 [s]; input x = x; measure y = y }\nback_" + name +
           " = fit " + name + " to made_" + name + " with map" + options + ", seed = 1\n";
  };
  std::string const text =
      model("echo", "  state q\n  initial q = 0\n  q = 0.5*lag(q, 1) + d(lag(q, 1), x)", "q", ", prediction = one_step") +
      model("heard", "", "0.5*lag(measured(y), 1) + d(lag(measured(y), 1), x)", "");
  CaseRun const run(text, {}), again(text, {});
  for (std::string const name : {"echo", "heard"}) {
    CAPTURE(name);
    nlohmann::json const sigma = parameter(run.summary("back_" + name), "sigma");
    // Where samples are lagged in place of states, their noise enters the next: 0.05 grows by up to the slope of the map.
    CHECK(sigma.at("mean").get<double>() > 0.04);
    CHECK(sigma.at("mean").get<double>() < 0.1);
    std::string const table = "truth_" + name + "/truth_" + name + ".csv";
    CHECK(run.file(table) == again.file(table));
    std::vector<double> const y = column(run.file(table), "y");
    double square = 0;
    for (double const value : y) square += value * value / static_cast<double>(y.size());
    CHECK(std::sqrt(square) > 0.3);  // there is a function at all
  }
}

TEST_CASE("what feeds back and never settles is said, not tried for ever") {
  // A chaotic map, and a covariance whose jitter depends on all samples: rounding in the first ones grows into the last ones.
  std::string const text = R"(
model echo {
  time discrete 1 [s]
  state q
  initial q = 0.3
  function d(before) ~ gp(linear(slope = 0.01))
  q = 3.9*lag(q, 1)*(1 - lag(q, 1)) + d(lag(q, 1))
  observe y ~ normal(q, sd = 0.01)
}
made = simulate echo with samples = 300, seed = 3, noise = 0
)";
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  try {
    run_text(folder.path() / "case.sysid", text, options);
    FAIL("it settled");
  } catch (UserError const& error) {
    CHECK(error.diagnostic().code == "E5001");
    CHECK(error.diagnostic().message.find("does not converge") != std::string::npos);
  }
  CHECK(!std::filesystem::exists(options.output / "made/made.csv"));
}

TEST_CASE("a finite sum is drawn from its prior where no values are given, and the file says which function it is") {
  std::string const text = R"(
model spring {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter a [N] ~ half_normal(sd = 10)
  function f(y) ~ gp(squared_exponential(amplitude = a, length = 2e-3 [m]), zero_at = 0, within = (-5e-3, 5e-3), terms = 10)
  1 [kg]*y'' + 20 [N s/m]*y' + 1e4 [N/m]*y + f(y) = x
  observe force ~ normal(f(y), sd = 1e-9 [N])
  observe displacement ~ normal(y, sd = 1e-9 [m])
}
made  = simulate spring with values(a = 5), input x = gaussian(sd = 10), samples = 400, rate = 1000 [Hz], seed = SEED
)";
  auto const made = [&](std::string const& seed) { return CaseRun(with(text, "SEED", seed), {}).file("made/made.csv"); };
  std::string const first = made("1"), other = made("2");
  CHECK(first == made("1"));
  CHECK(first.find("# function f drawn from its prior, coefficients of its terms: ") != std::string::npos);
  // One function of the displacement: samples nearby in it are nearby in force; of another seed another one.
  auto const force_at_half = [](std::string const& file) {
    std::vector<double> const y = column(file, "displacement_clean"), f = column(file, "force_clean");
    double place = 0;
    for (std::size_t i = 0; i < y.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (std::fabs(y[i] - y[j]) < 1e-6) CHECK(std::fabs(f[i] - f[j]) < 0.1);
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < y.size(); ++i)
      if (std::fabs(y[i] - 5e-4) < std::fabs(y[nearest] - 5e-4)) nearest = i;
    place = f[nearest];
    return place;
  };
  CHECK(std::fabs(force_at_half(first) - force_at_half(other)) > 0.1);
}
