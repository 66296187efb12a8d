// Records of unequal steps: what the regression reads, the noise they are given, and that the equation is found.
#include "discovery/preparation/equal_steps.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

std::vector<double> random_times(std::uint64_t seed, int count, double length) {
  Stream stream({seed, Purpose::input, 0, 0});
  std::vector<double> times = {0};
  for (int i = 1; i < count; ++i) times.push_back(length * stream.uniform());
  std::sort(times.begin(), times.end());
  return times;
}

}  // namespace

TEST_CASE("up to three missing samples in a row are filled in") {
  constexpr double missing = std::numeric_limits<double>::quiet_NaN();
  auto const cubic = [](double t) { return 1 - 2 * t + 0.5 * t * t * t; };
  Experiment experiment;
  experiment.measured.resize(2);
  for (int i = 0; i < 40; ++i) {
    bool const gone = i == 3 || (i >= 8 && i <= 10) || (i >= 20 && i < 30);
    experiment.time.push_back(0.1 * i);
    experiment.measured[0].push_back(gone ? missing : cubic(0.1 * i));
  }
  CHECK(fill_missing(experiment));
  for (std::size_t i = 0; i < 40; ++i)
    if (i < 20 || i >= 30)
      CHECK(experiment.measured[0][i] == doctest::Approx(cubic(experiment.time[i])).epsilon(1e-12));
    else
      CHECK(std::isnan(experiment.measured[0][i]));
  CHECK(experiment.measured[1].empty());
  CHECK_FALSE(fill_missing(experiment));
}

TEST_CASE("cubics and the rule of inputs are kept; where no sample is near, nothing is measured") {
  std::vector<double> const time = {0, 0.4, 1.3, 1.9, 3.1, 3.6, 4.2, 4.9, 40, 41};
  auto const cubic = [](double t) { return 1 - 2 * t + 0.5 * t * t * t; };
  Experiment experiment;
  experiment.name = "e";
  experiment.time = time;
  experiment.scored.assign(time.size(), 1);
  experiment.measured.resize(1);
  for (double const t : time) experiment.measured[0].push_back(cubic(t));
  experiment.inputs.emplace_back(InputRule::linear, time, time);
  Experiment const equal = at_equal_steps(experiment);
  REQUIRE(equal.time.size() == time.size());
  CHECK(unequal_step(equal.time) == 0);
  CHECK(equal.time.front() == 0);
  CHECK(equal.time.back() == 41);
  int measured = 0;
  for (std::size_t i = 0; i < equal.time.size(); ++i) {
    CHECK(equal.inputs[0].sample(static_cast<int>(i)) == doctest::Approx(equal.time[i]).epsilon(1e-14));
    if (std::isnan(equal.measured[0][i])) continue;
    ++measured;
    CHECK(equal.measured[0][i] == doctest::Approx(cubic(equal.time[i])).epsilon(1e-12));
  }
  CHECK(measured < 9);  // the mean step is 4.6: rows near 20 lie in the gap
  CHECK(measured >= 5);
}

TEST_CASE("a held input is its mean over each step, and samples that nearly coincide are one") {
  std::vector<double> const time = {0, 0.9, 2.1, 2.1 + 1e-7, 4};
  Experiment experiment;
  experiment.time = time;
  experiment.scored.assign(time.size(), 1);
  experiment.measured = {{0, 0.9, 2.0, 2.2, 4}};
  experiment.inputs.emplace_back(InputRule::zero_order, time, std::vector<double>{1, 2, 3, 3, 5});
  Experiment const equal = at_equal_steps(experiment);
  CHECK(equal.inputs[0].sample(0) == doctest::Approx(0.9 * 1 + 0.1 * 2).epsilon(1e-12));
  CHECK(equal.inputs[0].sample(1) == doctest::Approx(2).epsilon(1e-12));
  CHECK(equal.inputs[0].sample(2) == doctest::Approx(0.1 * 2 + 0.9 * 3).epsilon(1e-6));
  CHECK(equal.inputs[0].sample(3) == doctest::Approx(3).epsilon(1e-12));
  for (std::size_t i = 0; i < 5; ++i) CHECK(equal.measured[0][i] == doctest::Approx(equal.time[i]).epsilon(1e-6).scale(1));
}

TEST_CASE("the noise is estimated as large as it is, whatever the steps") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::vector<double> const time = random_times(seed, 400, 40);
    Stream noise({seed, Purpose::noise, 0, 0});
    std::vector<double> samples;
    for (double const t : time) samples.push_back(std::sin(t) + 0.03 * noise.normal());
    samples[17] = std::nan("");
    CAPTURE(seed);
    CHECK(*noise_at_unequal_steps(time, samples) == doctest::Approx(0.03).epsilon(0.25).scale(0));
  }
  CHECK_FALSE(noise_at_unequal_steps(std::vector<double>{0, 1, 2}, std::vector<double>{0, 1, 2}));
}

TEST_CASE("predator and prey counted at random times: the exact form, and coefficients within their sds") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    std::vector<double> const time = random_times(seed, 150, 20);
    Stream noise({seed, Purpose::noise, 0, 0});
    std::string csv = "t,x,y\n";
    double x = 1, y = 1;
    for (std::size_t i = 0; i < time.size(); ++i) {
      int const steps = i == 0 ? 0 : std::max(10, static_cast<int>((time[i] - time[i - 1]) / 0.002));
      double const h = i == 0 ? 0 : (time[i] - time[i - 1]) / steps;
      for (int k = 0; k < steps; ++k) {  // the midpoint rule
        double const u = x + h / 2 * (x - 0.6 * x * y), v = y + h / 2 * (-0.8 * y + 0.4 * x * y);
        x += h * (u - 0.6 * u * v);
        y += h * (-0.8 * v + 0.4 * u * v);
      }
      csv += fmt::format("{:.8g},{:.9g},{:.9g}\n", time[i], x + 0.02 * noise.normal(), y + 0.02 * noise.normal());
    }
    TemporaryFolder folder;
    write_file(folder.path() / "made.csv", csv);
    RunOptions options;
    options.output = folder.path() / "results";
    run_text(folder.path() / "made.sysid",
             "dictionary d { state x = x, y = y\n target = x', y'\n terms = polynomial(x, y, degree = 3), 1 }\n"
             "data record { file \"made.csv\"; time t [s]; measure x = x; measure y = y }\n"
             "found = discover d from record with spike_slab, seed = 1\n",
             options);
    json const summary = json::parse(read_file(folder.path() / "results/found/summary.json"));
    json const& first = summary.at("discovery").at("judged").at("structures").at(0);
    CHECK(first.at("terms") == "x': x, x*y; y': y, x*y");
    double const truth[] = {1, -0.6, -0.8, 0.4};
    REQUIRE(first.at("coefficients").size() == 4);
    for (std::size_t j = 0; j < 4; ++j) {  // a rate of all is the least known: the four are off together
      json const& each = first.at("coefficients").at(j);
      CHECK(std::abs(each.at("value").get<double>() - truth[j]) < 3.5 * each.at("sd").get<double>());
      CHECK(each.at("sd").get<double>() < 0.005 * std::abs(truth[j]));
    }
    bool noted = false;
    for (json const& each : summary.at("findings"))
      noted = noted || (each.at("code") == "steps_interpolated" && each.at("severity") == "note");
    CHECK(noted);
  }
}
