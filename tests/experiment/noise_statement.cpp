// The statements that findings on noise advise, from the user's text.
#include "experiment/noise_statement.hpp"

#include <doctest/doctest.h>

#include "check/checking.hpp"

using namespace sysid;

namespace {

struct Advised {
  std::string heavy, proportional;  // empty: nothing
};

/// Of a channel in m that reads a state in mm.
Advised advised(std::string const& noise) {
  std::string const text =
      "model m {\n state y [mm]\n initial y = 1\n parameter r [1/s] ~ uniform(0, 1)\n parameter s [mm] ~ uniform(0, 1)\n"
      " parameter v [mm^2] ~ uniform(0, 1)\n parameter p [1/mm^2] ~ uniform(0, 1)\n parameter q [-] ~ uniform(0, 1)\n"
      " y' = -r*y\n observe z [m] ~ " +
      noise + "\n}\n";
  CheckedFile const file = test::checked(text);
  Source const source("test.sysid", text);
  Channel const& channel = file.models.front().channels.front();
  auto const heavy = heavy_tailed_statement(source, channel);
  auto const proportional = proportional_statement(source, channel, "rel");
  for (auto const& line : {heavy, proportional})
    if (line) {
      // The line is one that the checker accepts.
      std::string cured = text;
      std::size_t const at = cured.find(" observe");
      cured.replace(at, cured.find('\n', at) - at, " parameter rel [-] ~ uniform(0, 1)\n " + *line);
      CHECK_MESSAGE(test::messages(cured).find("error[") == std::string::npos, test::messages(cured));
    }
  return {heavy.value_or(""), proportional.value_or("")};
}

}  // namespace

TEST_CASE("an sd, a variance and a precision are each rewritten") {
  Advised const sd = advised("normal(y, sd = s)");
  CHECK(sd.heavy == "observe z [m] ~ student_t(y, 4, scale = s)");
  CHECK(sd.proportional == "observe z [m] ~ normal(y, sd = sqrt(s^2 + (rel*y)^2))");
  Advised const variance = advised("normal(2*y, variance = v)");
  CHECK(variance.heavy == "observe z [m] ~ student_t(2*y, 4, scale = sqrt(v))");
  CHECK(variance.proportional == "observe z [m] ~ normal(2*y, sd = sqrt(v + (rel*(2*y))^2))");
  Advised const precision = advised("normal(y, precision = p*q)");
  CHECK(precision.heavy == "observe z [m] ~ student_t(y, 4, scale = 1/sqrt(p*q))");
  CHECK(precision.proportional == "observe z [m] ~ normal(y, sd = sqrt(1/(p*q) + (rel*y)^2))");
}

TEST_CASE("a number that would get another unit is not moved beside the signal") {
  for (std::string const bare : {"0.002", "0.001 + s", "q*s + 0.001", "max(s, 0.001)", "abs(-0.001)"}) {
    CAPTURE(bare);
    Advised const said = advised("normal(y, sd = " + bare + ")");
    CHECK_FALSE(said.heavy.empty());  // its scale has the unit that the sd had
    CHECK(said.proportional.empty());
  }
  CHECK(advised("normal(y, variance = 1e-6)").heavy.empty());
  CHECK(advised("normal(y, precision = 1e6)").proportional.empty());
  CHECK(advised("normal(y, sd = 0.002 [m])").proportional == "observe z [m] ~ normal(y, sd = sqrt((0.002 [m])^2 + (rel*y)^2))");
  CHECK_FALSE(advised("normal(y, sd = 2*s)").proportional.empty());  // a factor has no unit of its own
}

TEST_CASE("noise that is not normal has no such line") {
  CHECK(advised("student_t(y, 5, scale = s)").heavy.empty());
  CHECK(advised("student_t(y, 5, scale = s)").proportional.empty());
}

TEST_CASE("Poisson counts get the shape of a negative binomial") {
  std::string const text =
      "model m {\n state y [-]\n initial y = 1\n parameter r [1/s] ~ uniform(0, 1)\n parameter k [-] ~ uniform(0, 9)\n y' = r*y\n"
      " observe n ~ poisson(2*y)\n observe z ~ normal(y, sd = 1)\n}\n";
  CheckedFile const file = test::checked(text);
  Source const source("test.sysid", text);
  auto const line = overdispersed_statement(source, file.models.front().channels[0], "k");
  REQUIRE(line);
  CHECK(*line == "observe n ~ negative_binomial(2*y, shape = k)");
  std::string cured = text;
  std::string const stated = "observe n ~ poisson(2*y)";
  cured.replace(cured.find(stated), stated.size(), *line);
  CHECK_MESSAGE(test::messages(cured).find("error[") == std::string::npos, test::messages(cured));
  CHECK_FALSE(overdispersed_statement(source, file.models.front().channels[1], "k"));
}
