// Records made with functions drawn from their prior: fitted back, and the same twice.
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "app/tables.hpp"

using namespace sysid;

namespace {

nlohmann::json parameter(nlohmann::json const& summary, std::string const& name) {
  for (auto const& [key, value] : summary.at("parameters").items())
    if (key == name || (value.is_object() && value.contains("name") && value.at("name") == name)) return value;
  FAIL("no parameter " << name);
  return {};
}

}  // namespace

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
