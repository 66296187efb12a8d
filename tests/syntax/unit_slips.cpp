// What people write for a unit, and how it is to be written.
#include "syntax/unit_slips.hpp"

#include <doctest/doctest.h>

#include "core/numeric/unit.hpp"

using namespace sysid;

TEST_CASE("words that are no units are read as what they were meant for") {
  struct Slip {
    char const* written;
    char const* meant;
  };
  for (Slip const& each :
       {Slip{"m3", "m^3"}, {"s2", "s^2"},   {"cm2", "cm^2"},  {"kgm2", "kg m^2"}, {"Kg2", "kg^2"},   {"Kg", "kg"},
        {"KN", "kN"},      {"kn", "kN"},    {"mpa", "MPa"},   {"hz", "Hz"},       {"khz", "kHz"},    {"mn", "mm"},
        {"Nm", "N m"},     {"Ns", "N s"},   {"Nmm", "N mm"},  {"kNm", "kN m"},    {"kgK", "kg K"},   {"ms2", "m/s^2"},
        {"kmh", "km/h"},   {"M", "mol/l"},  {"mM", "mmol/l"}, {"uM", "umol/l"},   {"nM", "nmol/l"},  {"lbm", "lb"},
        {"lbs", "lb"},     {"klbf", "kip"}, {"mNm", "mN m"},  {"NS", "N s"},      {"mph", "mile/h"}, {"psf", "lbf/ft^2"},
        {"cSt", "mm^2/s"}}) {
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
