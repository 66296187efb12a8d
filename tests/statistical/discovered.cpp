// What a discovery's refit by simulation is worth over records of a known truth: the structure, the coefficients, and their sds.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "regression/problems.hpp"
#include "replications.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

double const truth[] = {1, 20, 1e4, 5e9};

/// The first structure of a record by simulation, from displacement and force alone.
json refitted(std::uint64_t seed, double noise) {
  TemporaryFolder folder;
  Experiment const made = regression::duffing_record(seed, 500, noise);
  std::string csv = "t,x,y\n";
  for (std::size_t i = 0; i < made.time.size(); ++i)
    csv += fmt::format("{:.17g},{:.17g},{:.17g}\n", made.time[i], made.inputs[0].sample(static_cast<int>(i)), made.measured[0][i]);
  write_file(folder.path() / "made.csv", csv);
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(folder.path() / "made.sysid", R"(
dictionary oscillator {
  input x [N]
  state y [m] = displacement
  target = x
  terms = y'', y', y, y^2, y^3, abs(y)*y', sign(y'), y'^2, abs(y')*y', y'^3, 1
}
data bench { file "made.csv"; time t [s]; input x = x [N] hold zero_order; measure displacement = y [m] }
found = discover oscillator from bench with seed = 1
)",
           options);
  return json::parse(read_file(options.output / "found/summary.json")).at("discovery").at("judged").at("structures").at(0);
}

}  // namespace

/// Errors of the four coefficients in percent, over records.
struct Errors {
  double sum[4] = {0, 0, 0, 0}, squares[4] = {0, 0, 0, 0};
  int count = 0;

  void add(json const& structure, char const* of) {
    ++count;
    for (std::size_t k = 0; k < 4; ++k) {
      double const error = 100 * (structure.at("coefficients").at(k).at(of).get<double>() / truth[k] - 1);
      sum[k] += error;
      squares[k] += error * error;
    }
  }
  std::string text() const {
    std::string mean, root;
    for (std::size_t k = 0; k < 4; ++k) {
      mean += fmt::format("{}{:.2f}", k == 0 ? "" : ", ", sum[k] / count);
      root += fmt::format("{}{:.2f}", k == 0 ? "" : ", ", std::sqrt(squares[k] / count));
    }
    return mean + " | " + root;
  }
};

std::string in_sds(double const (&squares)[4], int count) {
  std::string text;
  for (std::size_t k = 0; k < 4; ++k) text += fmt::format("{}{:.2f}", k == 0 ? "" : ", ", std::sqrt(squares[k] / count));
  return text;
}

// A full run prints the rows of the table in docs/methods/discovery.md, "Judged by simulation". An ordinary one finds sds of half
// their size, and coefficients that stay as the regression had them.
TEST_CASE("over made records the refit keeps the structure, and its coefficients are as near as its sds say") {
  int const records = replications(8, 20);
  for (double const noise : {0.01, 0.05}) {
    CAPTURE(noise);
    int exact = 0;
    double squares[4] = {0, 0, 0, 0}, sum[4] = {0, 0, 0, 0};
    double before[4] = {0, 0, 0, 0};  // squares of the regression's errors in its sds
    Errors regression, simulation;
    for (std::uint64_t const seed : counted_from(1, records)) {
      json const first = refitted(seed, noise);
      if (first.at("terms") != "y'', y', y, y^3") continue;
      ++exact;
      regression.add(first, "regression");
      simulation.add(first, "value");
      for (std::size_t k = 0; k < 4; ++k) {
        json const& each = first.at("coefficients").at(k);
        double const error = each.at("value").get<double>() - truth[k], z = error / each.at("sd").get<double>();
        squares[k] += z * z;
        sum[k] += z;
        before[k] += std::pow((each.at("regression").get<double>() - truth[k]) / each.at("regression_sd").get<double>(), 2);
        if (noise == 0.01) CHECK(std::abs(error) < (k == 3 ? 0.015 : 0.005) * truth[k]);
      }
    }
    CHECK(exact >= 0.9 * records - (records < 20 ? 0.5 : 0));
    MESSAGE(fmt::format("{} %, {} exact: mean | root mean square in percent; errors in sds", 100 * noise, exact));
    MESSAGE("regression | " << regression.text() << " | " << in_sds(before, exact));
    MESSAGE("simulation | " << simulation.text() << " | " << in_sds(squares, exact));
    MeanSquare const limits = mean_square_of(exact);
    for (std::size_t k = 0; k < 4; ++k) {
      CAPTURE(k);
      CHECK(squares[k] / exact > limits.least);
      CHECK(squares[k] / exact < limits.most);
      CHECK(std::abs(sum[k] / exact) < 3.3 / std::sqrt(exact));
    }
  }
}
