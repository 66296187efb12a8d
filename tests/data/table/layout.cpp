// Which lines of a text hold names, units and values.
#include "data/table/layout.hpp"

#include <doctest/doctest.h>

#include "data/table/proposal.hpp"
#include "data/table/reading_rules.hpp"

using namespace sysid;

namespace {

/// The line that is proposed for a text.
std::string proposed(std::string const& text) {
  auto const proposal = propose(text, {});
  return proposal ? reading_statement(proposal->rules.front()) : "none";
}

}  // namespace

TEST_CASE("a remark above the names is no row of units, whatever its words are") {
  std::string const rows = "0.00 2.041 0.57\n0.01 -2.196 0.46\n% new gain\n0.02 1.138 0.53\n";
  CHECK(proposed("% made by rig\n% t in s\nt x y\n" + rows) == "read names = 3, separator = blank, comments = \"%\"");
  CHECK(proposed("% made by rig\n% t in s\ntime x y\n" + rows) == "read names = 3, separator = blank, comments = \"%\"");
  // A comment has units where all of its cells are.
  CHECK(proposed("t x y\n% s N mm\n" + rows).find("units = 2") != std::string::npos);
  CHECK(proposed("t x y\n% s N rig\n" + rows).find("units") == std::string::npos);
}

TEST_CASE("rows of settings between the names and the units are neither") {
  std::string const rows = "0.00\t2.041\t0.57\n0.01\t-2.196\t0.46\n0.02\t1.138\t0.53\n";
  CHECK(proposed("root.name:\trun 12\n\nTime\tForce\tDisp\nwf_increment\t0.01\t0.01\nunit_string\tN\tmm\n" + rows) ==
        "read names = 3, units = 5");
  // Channels may be called by their numbers.
  CHECK(proposed("Date\t101\t102\ns\tN\tmm\n" + rows) == "read units = 2");
}

TEST_CASE("the rules of a table drawn with signs are left out") {
  CHECK(
      proposed("| t | x |\n|---|---|\n| 0.5 | 2 |\n| 1.0 | 3 |\n| 1.5 | 4 |\n").starts_with("read values = 3, separator = \"|\""));
  CHECK(proposed("t    x\n---- ----\n0.5  2\n1.0  3\n1.5  4\n") == "read values = 3, separator = blank");
}
