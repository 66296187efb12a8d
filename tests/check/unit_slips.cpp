// What people write for a unit, and how it is to be written.
#include "check/message/unit_slips.hpp"

#include <doctest/doctest.h>

#include "check/checking.hpp"
#include "core/numeric/unit.hpp"

using namespace sysid;

TEST_CASE("words that are no units are read as what they were meant for") {
  struct Slip {
    char const* written;
    char const* meant;
  };
  for (Slip const& each : {Slip{"m3", "m^3"},
                           {"s2", "s^2"},
                           {"cm2", "cm^2"},
                           {"kgm2", "kg m^2"},
                           {"Kg2", "kg^2"},
                           {"Kg", "kg"},
                           {"KN", "kN"},
                           {"kn", "kN"},
                           {"mpa", "MPa"},
                           {"hz", "Hz"},
                           {"khz", "kHz"},
                           {"mn", "mm"},
                           {"Nm", "N m"},
                           {"Ns", "N s"},
                           {"Nmm", "N mm"},
                           {"kNm", "kN m"},
                           {"kgK", "kg K"},
                           {"ms2", "m/s^2"},
                           {"kmh", "km/h"}}) {
    CAPTURE(each.written);
    REQUIRE_FALSE(unit_atom(each.written));
    auto const slip = unit_slip(each.written);
    REQUIRE(slip);
    CHECK(slip->meant == each.meant);
  }
}

TEST_CASE("where the letters do not tell nothing is made up") {
  for (char const* const word : {"foo", "foo2", "Nforce", "2", "", "newtom"}) {
    CAPTURE(word);
    CHECK_FALSE(unit_slip(word));
  }
}

TEST_CASE("a unit with several slips is told once, as it should be written whole") {
  for (auto const& [unit, whole] : {std::pair("N/m3", "[N/m^3]"),
                                    {"kgm/s2", "[kg m/s^2]"},
                                    {"kg/ms2", "[kg/(m s^2)]"},
                                    {"1/Nm", "[1/(N m)]"},
                                    {"Nm/Kg", "[N m/kg]"},
                                    {"J/kgK", "[J/(kg K)]"}}) {
    CAPTURE(unit);
    std::string const said =
        test::messages("model m {\nparameter c [" + std::string(unit) + "] = 1\nobserve d ~ normal(c, sd = 1)\n}\n");
    CHECK(said.find("E2011") == said.rfind("[E2011]") + 1);
    CHECK(said.find("`" + std::string(whole) + "`\n") != std::string::npos);
  }
}
