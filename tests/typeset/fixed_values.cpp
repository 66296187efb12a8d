// Parameters that are not estimated, read from a text.
#include "typeset/fixed_values.hpp"

#include <doctest/doctest.h>

namespace {

using sysid::FixedValue;

std::string written(std::vector<FixedValue> const& values) {
  std::string out;
  for (FixedValue const& each : values) out += each.name + " = " + each.value + " [" + each.unit + "]\n";
  return out;
}

}  // namespace

TEST_CASE("fixed values are those of the model, and per experiment those of its data blocks") {
  std::string const model =
      "model duffing {\n input x [N]\n state y [m]\n parameter m0 [kg] = 3.2\n parameter added per experiment [kg] = 0\n"
      " parameter c [N s/m] ~ log_uniform(1, 2)\n m0*y'' + c*y' = x\n observe y ~ normal(y, sd = 1)\n}\n";
  std::string const data =
      "data bench {\n file \"a.csv\"\n constant added = 500 [g]\n}\n"
      "data bare {\n file \"b.csv\"\n}\n";
  CHECK(written(sysid::fixed_values(model + data, "duffing", {"bench", "bare"})) ==
        "m0 = 3.2 [kg]\nadded[bench] = 500 [g]\nadded[bare] = 0 [kg]\n");
  // A prediction has the model alone.
  CHECK(written(sysid::fixed_values(model, "duffing", {"bench"})) == "m0 = 3.2 [kg]\n");
  CHECK(sysid::fixed_values(model, "other", {}).empty());
}
