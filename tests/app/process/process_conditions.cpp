// Functions known to vanish and to be flat at a point, through the language: what a regression gains by knowing it.
#include <doctest/doctest.h>

#include <cmath>
#include <sstream>

#include "app/running.hpp"
#include "app/tables.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

constexpr double force_noise = 0.05;  // [N]
double spring_force(double y) { return 2 * y * y * y; }

/// Forces of a cubic spring at 8 displacements in metres, then without noise at 9 between 0 and them.
std::string forces(std::uint64_t record) {
  Stream stream(StreamKey{.seed = 5, .purpose = Purpose::test, .index = record});
  std::ostringstream rows;
  rows.precision(17);
  rows << "y,force\n";
  for (int i = 0; i < 8; ++i) {
    double const y = 0.8 + 0.1 * i;
    rows << y << "," << spring_force(y) + force_noise * stream.normal() << "\n";
  }
  for (int i = 0; i < 9; ++i) rows << 0.08 * i << "," << spring_force(0.08 * i) << "\n";
  return rows.str();
}

std::string model(std::string const& name, std::string const& known) {
  return "model " + name + R"( {
  input y [m]
  parameter s     [N]  ~ log_normal(median = 3, sd = 1)
  parameter l     [m]  ~ log_normal(median = 0.7, sd = 0.5)
  parameter sigma [N]  ~ log_normal(median = 0.05, sd = 0.3)
  function f(v) ~ gp(squared_exponential(amplitude = s, length = l))" +
         known + R"()
  observe force [N] ~ normal(f(y), sd = sigma)
}
fit_)" + name +
         " = fit " + name + " to record.train with map, seed = 1\nahead_" + name + " = predict fit_" + name +
         " on record.test with draws(200), seed = 1\n";
}

}  // namespace

TEST_CASE("a spring that is known to be slack and flat at rest is known between rest and the data") {
  // One record may be lucky in what a free function makes of it: the errors of four are pooled.
  double error[2] = {0, 0}, width[2] = {0, 0};
  for (std::uint64_t record = 1; record <= 4; ++record) {
    CaseRun const run(model("free", "") + model("slack", ", zero_at = 0 [mm], flat_at = 0") + R"(
data record {
  file "rows.csv"
  input y = y [m]
  measure force = force [N]
  split train = rows 1..8, test = rows 9..17
}
)",
                      {{"rows.csv", forces(record)}});
    char const* const names[] = {"free", "slack"};
    for (int m = 0; m < 2; ++m) {
      std::string const table = run.file(std::string("ahead_") + names[m] + "/predict.csv");
      std::vector<double> mean = column(table, "force_mean"), sd = column(table, "force_sd");
      REQUIRE(mean.size() == 17);  // the rows fitted stand before
      mean.erase(mean.begin(), mean.begin() + 8);
      sd.erase(sd.begin(), sd.begin() + 8);
      for (std::size_t i = 0; i < 9; ++i) {
        error[m] += std::pow(mean[i] - spring_force(0.08 * static_cast<double>(i)), 2) / 36;
        width[m] += sd[i] * sd[i] / 36;
      }
      if (m == 1) CHECK(std::fabs(mean[0]) < 1e-4);
    }
  }
  for (int m = 0; m < 2; ++m) CHECK(std::sqrt(error[m]) < 3 * std::sqrt(width[m]));  // neither is wrong
  CHECK(std::sqrt(error[1]) < 0.5 * std::sqrt(error[0]));
  CHECK(std::sqrt(width[1]) < 0.5 * std::sqrt(width[0]));
}
