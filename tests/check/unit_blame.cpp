// One wrong declaration gives one message, which names it; mistakes that no declaration explains keep theirs.
#include "check/model/unit_blame.hpp"

#include "check/checking.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

int count(std::string const& text, std::string const& part) {
  int found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

std::string oscillator_with(std::string const& mass, std::string const& equation, std::string const& derived) {
  return "model m {\n input x [N]\n state y [m]\n initial y = 0, y' = 0\n parameter m [" + mass +
         "] ~ log_uniform(0.1, 10)\n parameter k [N/m] ~ log_uniform(1, 100)\n " + equation + "\n " + derived +
         "\n observe d ~ normal(y, sd = 1e-6)\n}\n";
}

}  // namespace

TEST_CASE("two places that one declaration contradicts are told once, with the unit that mends both") {
  std::string const said = messages(oscillator_with("N", "m*y'' + k*y = x", "derive omega [rad/s] = sqrt(k/m)"));
  CHECK(count(said, "error[") == 1);
  CHECK(said.find("one more place conflicts with this unit") != std::string::npos);
  CHECK(said.find("declare `m` in [kg]: then both places agree") != std::string::npos);
}

TEST_CASE("two mistakes that no declaration explains are both told") {
  std::string const said = messages(oscillator_with("kg", "m*y' + k*y = x", "derive omega [rad/s] = sqrt(k*m)"));
  CHECK(count(said, "error[") == 2);
  CHECK(said.find("places") == std::string::npos);
}

TEST_CASE("a mistake beside those of a declaration keeps its message") {
  std::string const said =
      messages(oscillator_with("N", "m*y'' + k*y = x", "derive omega [rad/s] = sqrt(k/m)\n derive work [J] = k*y^3"));
  CHECK(count(said, "error[") == 2);
  CHECK(said.find("declare `m` in [kg]") != std::string::npos);
  CHECK(said.find("k*y^3") != std::string::npos);
}
