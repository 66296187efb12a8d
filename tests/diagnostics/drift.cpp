// What a run says of constraints that the compiler differentiated.
#include <doctest/doctest.h>

#include <limits>

#include "app/running.hpp"
#include "diagnostics/drift.hpp"

using namespace sysid;

namespace {

/// Notices of the shipped pendulum simulated for 6 s with this solver.
std::string notices(std::string const& solver) {
  auto const file = std::filesystem::path(SYSID_SOURCE_DIR) / "models/pendulum/pendulum.sysid";
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  return run_text(file, with(read_file(file), "ida(relative = 1e-10)", solver), options, {"simulate"}).notices;
}

std::string const warning = "truth: warning: the solution does not satisfy the constraint `x^2 + y^2 = l^2` exactly";
std::string const note = "truth: the solution does not satisfy the constraint `x^2 + y^2 = l^2` exactly";

}  // namespace

TEST_CASE("of a constraint nothing is said where nothing could be simulated") {
  Source const source("m.sysid", "x^2 = 1");
  Model model;
  model.invariants.push_back({});
  model.invariants.front().span = {0, 7};
  Trajectory::Result result;
  double const nothing = std::numeric_limits<double>::quiet_NaN();
  result.drift = {{nothing, nothing}};
  CHECK(drift_findings(source, model, result, "bench").empty());
  result.drift = {{nothing, 0.5}};
  CHECK(drift_findings(source, model, result, "bench").size() == 1);
}

TEST_CASE("a constraint that drifts by more than a thousandth of its terms is warned of, by less is noted") {
  std::string const loose = notices("cvode(relative = 1e-3)"), tight = notices("ida(relative = 1e-8)");
  CHECK_MESSAGE(loose.find(warning) != std::string::npos, loose);
  CHECK_MESSAGE(tight.find(warning) == std::string::npos, tight);
  CHECK_MESSAGE(tight.find(note) != std::string::npos, tight);
}
