// A Gaussian process beside differential equations: the equations, and what the sensor adds to them, from one record.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/running.hpp"
#include "app/tables.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

constexpr double mass = 1, damping = 2, stiffness = 400, step = 0.02, noise = 2e-4;  // SI
constexpr int samples = 300, trained = 200;

/// What the sensor adds to a displacement.
double bend(double y) { return 3 * y * y; }

struct Record {
  std::string csv;
  std::vector<double> clean;  // what the sensor says, without noise
};

/// An oscillator under a force held over each interval, by 50 Runge-Kutta steps in each.
Record record() {
  Stream stream(StreamKey{.seed = 9});
  std::ostringstream rows;
  rows.precision(17);
  rows << "t,force,reading\n";
  Record result;
  double y = 0, v = 0;
  for (int i = 0; i < samples; ++i) {
    double const force = 12 * stream.normal();
    result.clean.push_back(y + bend(y));
    rows << i * step << "," << force << "," << result.clean.back() + noise * stream.normal() << "\n";
    double const h = step / 50;
    for (int n = 0; n < 50; ++n) {
      auto const rate = [&](double position, double velocity) {
        return (force - damping * velocity - stiffness * position) / mass;
      };
      double const a1 = rate(y, v), v2 = v + h / 2 * a1, a2 = rate(y + h / 2 * v, v2), v3 = v + h / 2 * a2,
                   a3 = rate(y + h / 2 * v2, v3), v4 = v + h * a3, a4 = rate(y + h * v3, v4);
      y += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
      v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
  }
  result.csv = rows.str();
  return result;
}

std::string model(std::string const& name, std::string const& process, std::string const& centre) {
  return "model " + name + R"( {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter c     [N s/m] ~ log_normal(median = 3, sd = 1)
  parameter k     [N/m]   ~ log_normal(median = 300, sd = 0.7)
  parameter sigma [m]     ~ log_normal(median = 1e-3, sd = 1.5)
)" + process +
         R"(
  1 [kg]*y'' + c*y' + k*y = x
  observe reading [m] ~ normal()" +
         centre + ", sd = sigma)\n}\nfit_" + name + " = fit " + name + " to bench.train with map, seed = 1\nahead_" + name +
         " = predict fit_" + name + " on bench.test with draws(100), seed = 1\n";
}

}  // namespace

TEST_CASE("what a sensor adds to a motion is found beside the motion's equation, and forecasts know it") {
  Record const made = record();
  CaseRun const run(model("plain", "", "y") +
                        model("bent", R"(
  parameter s [m] ~ log_normal(median = 0.01, sd = 1)
  parameter l [m] ~ log_normal(median = 0.1, sd = 0.7)
  function f(at) ~ gp(squared_exponential(amplitude = s, length = l), zero_at = 0, flat_at = 0))",
                              "y + f(y)") +
                        R"(
data bench {
  file "bench.csv"
  time t [s]
  input x = force [N] hold zero_order
  measure reading = reading [m]
  split train = rows 1..200, test = rows 201..300
}
)",
                    {{"bench.csv", made.csv}});
  auto const error = [&](std::string const& name) {
    std::vector<double> const mean = column(run.file("ahead_" + name + "/predict.csv"), "reading_mean");
    REQUIRE(mean.size() >= samples - trained);
    double sum = 0;
    for (int i = 0; i < samples - trained; ++i) {
      auto const back = static_cast<std::size_t>(i + 1);
      sum += std::pow(mean[mean.size() - back] - made.clean[made.clean.size() - back], 2);
    }
    return std::sqrt(sum / (samples - trained));
  };
  CHECK(error("bent") < noise);
  CHECK(error("plain") > 5 * noise);
  nlohmann::json const bent = run.summary("fit_bent").at("parameters");
  auto const value = [&](char const* name) {
    for (auto const& [key, each] : bent.items())
      if (key == name || (each.is_object() && each.contains("name") && each.at("name") == name)) return each;
    FAIL("no parameter");
    return nlohmann::json();
  };
  for (auto const& [name, truth] : {std::pair{"c", damping}, std::pair{"k", stiffness}, std::pair{"sigma", noise}}) {
    CAPTURE(name);
    double const mean = value(name).at("mean").get<double>(), sd = value(name).at("sd").get<double>();
    CHECK(std::fabs(mean - truth) < 4 * sd);
    CHECK(sd < 0.1 * truth);
  }
  // The function itself, where the record has been: what the forecast has beyond its parametric part.
  std::string const table = run.file("ahead_bent/predict.csv");
  std::vector<double> const mean = column(table, "reading_mean"), white = column(table, "white(reading)_mean");
  double most = 0;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    CHECK(std::fabs(mean[i] - white[i] - bend(white[i])) < 5 * noise);
    most = std::max(most, bend(white[i]));
  }
  CHECK(most > 20 * noise);
}
