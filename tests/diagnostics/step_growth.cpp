// Steps that grow where the motion does not, in whatever units the states are.
#include "diagnostics/tolerance/step_growth.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "load/load.hpp"

using namespace sysid;

namespace {

/// Of the prior, for a record of steps of h seconds.
double growing_share(std::string const& model, double h) {
  Source source("case.sysid", model);
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  ParameterSpace const space(file->models.front(), {{"record", {}}});
  Experiment experiment;
  experiment.name = "record";
  for (int i = 0; i < 20; ++i) experiment.time.push_back(h * i);
  return share_of_growing_steps(space, {experiment}, {.method = "rk4"});
}

std::string damped_motion(std::string const& frequency) {
  return "model m {\n  state y [m]\n  initial y = 0, y' = 1\n  parameter w [1/s] ~ " + frequency +
         "\n  y'' + 0.002*w*y' + w^2*y = 0\n  observe d [m] ~ normal(y, sd = 1)\n}\n";
}

}  // namespace

TEST_CASE("steps that follow a motion do not grow, however many, whatever the units of its states") {
  std::string const cart =
      "model m {\n  input u\n  state y\n  initial y = 0, y' = 0\n  parameter b ~ log_uniform(0.1, 10)\n  y'' = b*u\n"
      "  observe d ~ normal(y, sd = 1)\n}\n";
  CHECK(growing_share(cart, 60) == 0);
  CHECK(growing_share(damped_motion("log_uniform(5e4, 2e5)"), 1e-6) == 0);
  CHECK(growing_share(damped_motion("log_uniform(0.1, 1)"), 1) == 0);
  std::string const unstable =
      "model m {\n  state y\n  initial y = 1\n  parameter r [1/s] ~ log_uniform(0.1, 1)\n  y' = r*y\n"
      "  observe d ~ normal(y, sd = 1)\n}\n";
  CHECK(growing_share(unstable, 1) == 0);  // the motion grows, too
}

TEST_CASE("the share of the prior beyond the limit of the steps is counted, beside motion that grows by itself") {
  CHECK(growing_share(damped_motion("log_uniform(4, 40)"), 1) == 1);
  // Uniform in log w between 0.28 and 28: the limit 2.83 of the imaginary axis halves it.
  CHECK(growing_share(damped_motion("log_uniform(0.283, 28.3)"), 1) == doctest::Approx(0.5).epsilon(0.15));
  std::string const both =
      "model m {\n  state y, z\n  initial y = 1, z = 1\n  parameter r [1/s] ~ log_uniform(0.4, 0.6)\n"
      "  y' = r*y\n  z' = -6*r*z\n  observe d ~ normal(y + z, sd = 1)\n}\n";
  CHECK(growing_share(both, 1) > 0.5);  // 6 r of 2.79 and more
}
