// What is said of dry friction, and that nothing is said of models without it.
#include "experiment/sticking.hpp"

#include <doctest/doctest.h>

#include "load/load.hpp"

using namespace sysid;

namespace {

Model rig(std::string const& force) {
  Source source("rig.sysid",
                "model rig {\n input x [N]\n state y [m]\n initial y = 0, y' = 0\n parameter F [N] ~ log_uniform(1, 10)\n"
                "1 [kg]*y'' + 1e4 [N/m]*y + " +
                    force + " = x\n observe d ~ normal(y, sd = 1e-5)\n}\n");
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  REQUIRE(file);
  return file->models.front();
}

/// Two samples, 0.02 m in 0.1 s: 0.2 m/s.
std::vector<ExperimentData> sticking_record() {
  ExperimentData data;
  data.experiment.time = {0, 0.1, 0.2};
  data.experiment.measured = {{0, 0.02, 0.04}};
  return {data};
}

}  // namespace

TEST_CASE("friction by the sign of a velocity is sent to a smooth form with a scale of the record") {
  CHECK(sticking_advice(rig("F*sign(y')"), {}).find("`tanh(y'/vs)`") != std::string::npos);
  CHECK(sticking_advice(rig("F*sign(y')"), sticking_record()).find("`tanh(y'/(0.002 [m/s]))`") != std::string::npos);
}

TEST_CASE("models that do not stick get no such advice") {
  CHECK(sticking_advice(rig("F*tanh(y'/1 [mm/s])"), sticking_record()).empty());
  CHECK(sticking_advice(rig("F*sign(x)"), sticking_record()).empty());
}
