// The widths of noise that `check` weighs responses by.
#include "likelihood/output.hpp"

#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>

#include "load/load.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

/// The noise of each sample of a position and of a positive quantity that a random force moves, the channels with these noises.
std::vector<double> widths_of_noise(std::string const& position, std::string const& positive) {
  Source source("case.sysid", fmt::format(R"(
model pushed {{
  state x [m]
  initial x = 0.2
  parameter a [1/s] ~ log_uniform(0.5, 1)
  disturbance w [m/s] ~ white(intensity = 1e-4)
  x' = -a*x + w
  observe where [m] ~ {}
  observe amount [m] ~ {}
}}
)",
                                          position, positive));
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  Experiment experiment;
  experiment.measured.resize(2);
  for (int i = 0; i < 20; ++i) {
    experiment.time.push_back(0.1 * i);
    experiment.measured[0].push_back(0.2 * std::exp(-0.07 * i));
    experiment.measured[1].push_back(3 + experiment.measured[0].back());
  }
  experiment.scored.assign(20, 1);
  auto const compiled = compile(file->models.front(), false, "rk4", FilterRule::particle);
  auto const space = std::make_shared<ParameterSpace const>(compiled->model, std::vector<ExperimentMember>{{"case", {}}});
  Output const output(compiled, space, {experiment}, {.substeps = 4}, 0, {}, nullptr);
  LaneArray const theta(space->dimension(), 1);  // the middle of the prior
  return output.noise(space->values(theta));
}

}  // namespace

TEST_CASE("the noise of a channel beside random states is the normal one that the filter has in its place") {
  // Mean and variance of student_t(4) and of log_normal with the sd 0.1 of the logarithm.
  std::vector<double> const found =
      widths_of_noise("student_t(x, 4, scale = 0.01 [m])", "log_normal(median = 3 [m] + x, sd = 0.1)");
  std::vector<double> const expected = widths_of_noise(fmt::format("normal(x, sd = {:.17g} [m])", 0.01 * std::sqrt(2)),
                                                       fmt::format("normal((3 [m] + x)*{:.17g}, sd = (3 [m] + x)*{:.17g})",
                                                                   std::exp(0.005), std::sqrt(std::exp(0.01) * std::expm1(0.01))));
  REQUIRE(found.size() == 40);
  for (std::size_t r = 0; r < found.size(); ++r) {
    CAPTURE(r);
    CHECK(found[r] == relative(expected[r], 1e-6));
  }
  // Of the first sample, whose state is known, it is that of the sensor alone.
  CHECK(found[0] == relative(0.01 * std::sqrt(2), 1e-3));
  CHECK(found[20] == doctest::Approx(3.2 * std::sqrt(std::exp(0.01) * std::expm1(0.01))).epsilon(1e-3));
}
