// Rows, names and the joint prior of parameters over several experiments, against densities written out by hand.
#include "likelihood/parameter_space.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/text/diagnostic.hpp"
#include "load/load.hpp"

using namespace sysid;

namespace {

Model model_with(std::string const& parameters) {
  Source source("case.sysid",
                "model m {\ninput x\nstate y\ninitial y = 0\n" + parameters + "\ny' = x\nobserve level ~ normal(y, sd = 1)\n}\n");
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  return file->models.front();
}

std::string const hierarchy =
    "parameter mu [N/mm] ~ normal(10, sd = 2)\n"
    "parameter tau [N/mm] ~ half_normal(3)\n"
    "parameter k per experiment [N/mm] ~ normal(mu, sd = tau, lower = 0)\n"
    "parameter m per experiment [kg] = 2\n"
    "parameter s ~ log_uniform(1, 10)\n";

double normal_log_density(double x, double mean, double sd) {
  return -0.5 * std::log(2 * std::numbers::pi) - std::log(sd) - 0.5 * (x - mean) * (x - mean) / (sd * sd);
}
double phi(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

std::vector<std::optional<double>> constants(std::initializer_list<std::pair<int, double>> given) {
  std::vector<std::optional<double>> values(5);
  for (auto const& [p, value] : given) values[static_cast<std::size_t>(p)] = value;
  return values;
}

}  // namespace

TEST_CASE("an experiment's own parameter is named by it, also where it has an index already") {
  CHECK(member_name("k", "bench") == "k[bench]");
  CHECK(member_name("k", "bench.train") == "k[bench.train]");
  CHECK(member_name("q[2]", "bench") == "q[2,bench]");
  CHECK(member_name("k", "") == "k");
}

TEST_CASE("own parameters take a row per experiment in their place; what a data block fixes is not sampled") {
  ParameterSpace const space(model_with(hierarchy),
                             {{"a", constants({})}, {"b", constants({{2, 8e3}})}, {"c", constants({{3, 7}})}});
  std::vector<std::string> rows, sampled;
  for (FittedParameter const& row : space.rows()) rows.push_back(row.name);
  for (ParameterInfo const& info : space.infos()) sampled.push_back(info.name);
  CHECK(rows == std::vector<std::string>{"mu", "tau", "k[a]", "k[b]", "k[c]", "m[a]", "m[b]", "m[c]", "s"});
  CHECK(sampled == std::vector<std::string>{"mu", "tau", "k[a]", "k[c]", "s"});
  CHECK(space.infos()[2].lower == 0);
  CHECK(space.infos()[2].unit == "N/mm");

  LaneArray declared(5, 1), parameters(5, 1);
  double const values[] = {9, 2, 11, 7, 3};
  for (int p = 0; p < 5; ++p) declared(p, 0) = values[p];
  auto const of = [&](int experiment) {
    space.select(space.values_of_declared(declared), experiment, parameters);
    std::vector<double> out;
    for (int p = 0; p < 5; ++p) out.push_back(parameters(p, 0));
    return out;
  };
  CHECK(of(0) == std::vector<double>{9e3, 2e3, 11e3, 2, 3});
  CHECK(of(1) == std::vector<double>{9e3, 2e3, 8e3, 2, 3});
  CHECK(of(2) == std::vector<double>{9e3, 2e3, 7e3, 7, 3});
}

TEST_CASE("the joint prior is the product over the experiments given what they share; the Jacobian follows the coordinates") {
  ParameterSpace const space(model_with(hierarchy), {{"a", {}}, {"b", constants({{2, 8e3}})}, {"c", {}}});
  double const values[] = {9, 2, 11, 7, 3};  // mu, tau, k[a], k[c], s
  LaneArray declared(5, 1), theta(5, 1), back(5, 1);
  for (int p = 0; p < 5; ++p) declared(p, 0) = values[p];
  space.unconstrain(declared, theta);
  space.constrain(theta, back);
  for (int p = 0; p < 5; ++p) CHECK(back(p, 0) == doctest::Approx(values[p]).epsilon(1e-12));
  std::vector<double> out(1), with(1);
  space.log_prior(theta, out, false);
  space.log_prior(theta, with, true);
  // The fixed member is no draw from the population.
  double const by_hand = normal_log_density(9, 10, 2) + std::log(2.0) + normal_log_density(2, 0, 3) + normal_log_density(11, 9, 2) +
                         normal_log_density(7, 9, 2) - 2 * std::log(phi(9.0 / 2)) - std::log(3 * std::log(10.0));
  CHECK(out[0] == doctest::Approx(by_hand).epsilon(1e-11));
  // mu moves freely in SI, tau and the ks by a logarithm, s between its logarithmic bounds.
  double const share = std::log(3.0) / std::log(10.0);
  double const jacobian =
      -std::log(1e3) + std::log(2.0) + std::log(11.0) + std::log(7.0) + std::log(3 * std::log(10.0) * share * (1 - share));
  CHECK(with[0] - out[0] == doctest::Approx(jacobian).epsilon(1e-9));
}

TEST_CASE("draws from a hierarchical prior have the moments of the population") {
  ParameterSpace const space(model_with("parameter mu ~ normal(1, sd = 2)\nparameter k per experiment ~ normal(mu, sd = 0.5)"),
                             {{"a", {}}, {"b", {}}});
  int const n = 20000;
  LaneArray theta(3, n), declared(3, n);
  space.sample_prior({7, Purpose::prior, 0, 0}, theta);
  space.constrain(theta, declared);
  double within = 0, between = 0, mean = 0;
  for (int w = 0; w < n; ++w) {
    double const a = declared(1, w), b = declared(2, w);
    mean += a / n;
    within += (a - b) * (a - b) / 2 / n;
    between += (a - 1) * (b - 1) / n;
  }
  // Variances 0.25 within and 4 between; relative standard errors sqrt(2/n) and below 2 sqrt(2/n).
  CHECK(std::abs(mean - 1) < 4 * std::sqrt(4.25 / n));
  CHECK(within == doctest::Approx(0.25).epsilon(4 * std::sqrt(2.0 / n)));
  CHECK(between == doctest::Approx(4).epsilon(8 * std::sqrt(2.0 / n)));
}

TEST_CASE("a new experiment draws its own parameters given the shared ones and takes its constants as they are") {
  ParameterSpace const space(model_with(hierarchy), {{"a", {}}, {"b", {}}});
  int const n = 20000;
  LaneArray declared(space.dimension(), n);
  for (int w = 0; w < n; ++w) {
    declared(0, w) = 50;                     // mu
    declared(1, w) = w < n / 2 ? 1.0 : 2.0;  // tau
    declared(2, w) = declared(3, w) = 1;     // of the fitted experiments: of no concern
    declared(4, w) = 3;
  }
  LaneArray const drawn = space.of_new_experiment(declared, constants({{3, 9}}), {3, Purpose::population, 0, 0});
  double narrow = 0, wide = 0;
  for (int w = 0; w < n; ++w) {
    double const z = drawn(2, w) / 1e3 - 50;
    (w < n / 2 ? narrow : wide) += z * z / (n / 2);
    CHECK(drawn(3, w) == 9);
  }
  CHECK(narrow == doctest::Approx(1).epsilon(4 * std::sqrt(4.0 / n)));
  CHECK(wide == doctest::Approx(4).epsilon(4 * std::sqrt(4.0 / n)));
  LaneArray const fixed = space.of_new_experiment(declared, constants({{2, 6e3}}), {3, Purpose::population, 0, 0});
  CHECK(fixed(2, 0) == 6e3);
  CHECK(fixed(3, 0) == 2);
}

TEST_CASE("the slopes of values by coordinates are those of differences, also at 0 and through estimated bounds") {
  ParameterSpace const space(model_with("parameter free ~ normal(0, sd = 1)\n"
                                        "parameter positive ~ half_normal(2)\n"
                                        "parameter negative ~ normal(0, sd = 1, upper = 3)\n"
                                        "parameter between ~ uniform(-1, 2)\n"
                                        "parameter decades ~ log_uniform(0.1, 1000)\n"
                                        "parameter share ~ beta(2, 3)\n"
                                        "parameter own per experiment ~ normal(free, sd = positive)\n"
                                        "parameter tied per experiment ~ uniform(-positive, positive + 2*share)\n"),
                             {{"a", {}}, {"b", {}}});
  int const rows = static_cast<int>(space.rows().size()), dimension = space.dimension();
  LaneArray theta(dimension, 3);
  space.sample_prior({3, Purpose::prior, 0, 0}, theta);
  for (int p = 0; p < dimension; ++p) theta(p, 2) = 0;
  LaneArray slopes(static_cast<int>(space.slopes().size()), 3);
  space.slopes(theta, slopes);
  constexpr double h = 1e-5;
  for (int c = 0; c < dimension; ++c) {
    LaneArray ahead = theta, behind = theta;
    for (int w = 0; w < 3; ++w) ahead(c, w) += h, behind(c, w) -= h;
    LaneArray const up = space.values(ahead), down = space.values(behind);
    for (int r = 0; r < rows; ++r)
      for (int w = 0; w < 3; ++w) {
        double found = 0;
        for (std::size_t s = 0; s < space.slopes().size(); ++s)
          if (space.slopes()[s].row == r && space.slopes()[s].coordinate == c) found = slopes(static_cast<int>(s), w);
        double const expected = (up(r, w) - down(r, w)) / (2 * h);
        CHECK(found == doctest::Approx(expected).epsilon(1e-7).scale(1));
        auto const& read = space.coordinates_of(r);
        if (expected != 0) CHECK(std::find(read.begin(), read.end(), c) != read.end());
      }
  }
}
