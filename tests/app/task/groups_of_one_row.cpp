// A population whose groups have one row each: the eight schools of Rubin (1981), as Gelman et al. (2013, 5.5) treat them.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

#include "app/running.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

constexpr double effects[] = {28, 8, -3, 7, -1, 1, 18, 12}, errors_of_effects[] = {15, 10, 16, 11, 9, 11, 10, 18};

double value_of(json const& summary, std::string const& name, std::string const& key) {
  return parameter(summary, name).at(key).get<double>();
}

}  // namespace

TEST_CASE("eight schools, a row each: the posterior is that by quadrature") {
  std::string text =
      "model school {\n input error\n parameter mu ~ normal(0, sd = 5)\n parameter tau ~ half_cauchy(scale = 5)\n"
      " parameter theta per experiment ~ normal(mu, sd = tau)\n observe effect ~ normal(theta, sd = error)\n}\n";
  std::vector<std::pair<std::string, std::string>> files;
  std::string all;
  for (int j = 0; j < 8; ++j) {
    files.emplace_back(fmt::format("s{}.csv", j), fmt::format("effect,error\n{},{}\n", effects[j], errors_of_effects[j]));
    text += fmt::format("data s{0} {{ file \"s{0}.csv\"; input error = error; measure effect = effect }}\n", j);
    all += (j == 0 ? "s" : ", s") + std::to_string(j);
  }
  CaseRun const run(text + "post = fit school to " + all + " with mh, seed = 1\n", files);
  json const summary = run.summary("post");
  // numpy, a grid of 1201 x 4001 over mu and log tau, the effects integrated out.
  for (auto const& [name, mean, sd] : {std::tuple("mu", 4.397, 3.318), {"tau", 3.598, 3.220}}) {
    CAPTURE(name);
    CHECK(std::abs(value_of(summary, name, "mean") - mean) < 4 * value_of(summary, name, "mcse_mean"));
    CHECK(value_of(summary, name, "sd") == doctest::Approx(sd).epsilon(0.1));
  }
  for (json const& each : summary.at("findings")) CHECK(each.at("severity") != "error");
}
