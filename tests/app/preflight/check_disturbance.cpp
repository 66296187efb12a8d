// What `check` says of a disturbance and the noise of a measurement: which of both a record could tell apart.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include "app/checking.hpp"
#include "app/running.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

bool contains(std::string const& text, std::string const& part) { return text.find(part) != std::string::npos; }

/// x' = -a x + w, seen with noise: 400 samples of noise of about the size that draws have.
std::string noise_record(double step) {
  Stream stream({1, Purpose::test});
  std::string text = "t,m\n";
  for (int i = 0; i < 400; ++i) text += fmt::format("{},{}\n", step * i, stream.normal());
  return text;
}

std::string const leak = R"(
model leak {
  state x
  initial x = 1
  parameter a [1/s] ~ log_normal(median = 0.5, sd = 0.1)
  parameter q [1/s] ~ log_uniform(1e-8, 100)
  parameter sigma ~ log_uniform(0.01, 1)
  disturbance w [1/s] ~ white(intensity = q)
  x' = -a*x + w
  observe m ~ normal(x, sd = sigma)
}
data d { file "d.csv"; time t [s]; measure m = m }
post = fit leak to d with map, seed = 1
)";

struct Said {
  std::string line;  // of the page; empty: none
  int warnings = 0;
};

Said said_of(std::string const& text, double step) {
  TemporaryFolder folder;
  write_file(folder.path() / "d.csv", noise_record(step));
  CheckResult const result = checked(folder.path() / "case.sysid", text);
  Said said;
  for (std::string const& each : preflight(result, "post").disturbances) said.line += each;
  for (Finding const& finding : preflight(result, "post").findings)
    said.warnings += finding.code == FindingCode::disturbance_and_noise && finding.severity == Severity::warning ? 1 : 0;
  return said;
}

}  // namespace

TEST_CASE("a disturbance of a motion that is sampled often is told from noise, above a size that is named") {
  Said const said = said_of(leak, 0.1);
  INFO(said.line);
  CHECK(said.line.starts_with("w and measurement noise: the record is expected to determine q only if its value is above about "));
  CHECK(contains(said.line, "sigma"));
  CHECK(said.warnings == 0);
}

TEST_CASE("a motion that has leaked between samples looks like noise, and nothing tells both apart") {
  // Samples are independent, of variance q/(2 a) + sigma^2.
  Said const said = said_of(with(leak, "median = 0.5", "median = 50"), 1);
  INFO(said.line);
  CHECK(said.warnings == 1);
}

TEST_CASE("where the noise is known a disturbance that is larger can be seen") {
  Said const said = said_of(
      with(with(leak, "median = 0.5", "median = 50"), "  parameter sigma ~ log_uniform(0.01, 1)\n", "  parameter sigma = 0.1\n"),
      1);
  INFO(said.line);
  CHECK(contains(said.line, "determine q only if its value is above about"));
  CHECK_FALSE(contains(said.line, "sigma"));
  CHECK(said.warnings == 0);
}

TEST_CASE("nothing is said of a disturbance whose size is stated, or of a model without one") {
  CHECK(said_of(with(leak, "  parameter q [1/s] ~ log_uniform(1e-8, 100)\n", "  parameter q [1/s] = 1\n"), 0.1).line.empty());
  std::string const plain = with(
      with(with(leak, "  parameter q [1/s] ~ log_uniform(1e-8, 100)\n", ""), "  disturbance w [1/s] ~ white(intensity = q)\n", ""),
      " + w", "");
  CHECK(said_of(plain, 0.1).line.empty());
}
