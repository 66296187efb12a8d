// `sysid check` of Gaussian processes at samples: silent on priors that suit the data, and naming those that do not.
#include "app/preflight/check_process.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <sstream>

#include "app/checking.hpp"
#include "core/numeric/random.hpp"
#include "relative.hpp"
#include "temporary_folder.hpp"

using namespace sysid;

namespace {

/// 61 rows, x from -3 to 3 in steps of a tenth, the last of them twice; y of sd 1.
std::string rows() {
  std::ostringstream out;
  out << "x,y\n";
  for (int i = -30; i <= 30; ++i) out << 0.1 * i << "," << std::sqrt(2.0) * std::sin(2.0943951 * 0.1 * i) << "\n";
  out << "3,0\n";
  return out.str();
}

CheckResult look(std::string const& amplitude, std::string const& length, std::string const& noise) {
  TemporaryFolder folder;
  write_file(folder.path() / "points.csv", rows());
  return checked(folder.path() / "case.sysid", "model wave {\n  input x [s]\n  parameter s ~ " + amplitude +
                                                   "\n  parameter l [s] ~ " + length + "\n  parameter sigma ~ " + noise + R"(
  function d(u) ~ gp(matern52(amplitude = s, length = l))
  observe y ~ normal(d(x), sd = sigma)
}
data points { file "points.csv"; input x = x [s]; measure y = y }
best = fit wave to points with map, seed = 1
)");
}

}  // namespace

TEST_CASE("priors that suit the data are shown beside them, without a finding") {
  CheckResult const result = look("half_normal(sd = 3)", "log_uniform(0.2, 10)", "half_normal(sd = 1)");
  PreflightPage const& preflight = sysid::preflight(result, "best");
  CHECK(preflight.findings.empty());
  REQUIRE(preflight.processes.size() == 1);
  ProcessPage const& page = preflight.processes.front();
  CHECK(page.rows == 62);
  CHECK(page.repeated == 1);
  CHECK(page.failed == 0);
  CHECK(page.measured_sd == doctest::Approx(1).epsilon(0.05));
  REQUIRE(page.lines.size() == 3);
  CHECK(page.lines[0].what == "amplitude");
  CHECK(page.lines[1].what == "length");
  REQUIRE(page.lines[1].inputs);
  CHECK(page.lines[1].inputs->range == doctest::Approx(6));
  CHECK(page.lines[1].inputs->spacing == relative(0.1, 1e-12));
  CHECK(page.lines[1].inputs->places == 61);
  // log_uniform(0.2, 10): the median is the geometric mean, 64 draws scatter by a factor of exp(1.13 * 1.25/8) about it.
  CHECK(std::fabs(std::log(page.lines[1].prior.middle / std::sqrt(2.0))) < 3 * 1.13 * 1.25 / 8);
}

TEST_CASE("priors of another size than the data are named") {
  char const *amplitude = "half_normal(sd = 3)", *length = "log_uniform(0.2, 10)", *noise = "half_normal(sd = 1)";
  CHECK(messages(look(amplitude, "log_uniform(1e-4, 1e-2)", noise), "length_and_inputs").size() == 1);
  CHECK(messages(look(amplitude, "log_uniform(1e3, 1e4)", noise), "length_and_inputs").size() == 1);
  CHECK(messages(look("half_normal(sd = 3000)", length, noise), "prior_far_from_data").size() == 1);
  CHECK(messages(look("half_normal(sd = 0.001)", length, noise), "prior_far_from_data").size() == 1);
  CHECK(messages(look(amplitude, length, "half_normal(sd = 1000)"), "prior_far_from_data").size() == 1);
  // A small noise is no mistake.
  CHECK(look(amplitude, length, "half_normal(sd = 0.001)").page.tasks.front().all_findings().empty());
  CHECK(messages(look("normal(-1, sd = 1)", length, noise), "prior_fails").size() == 1);
}
