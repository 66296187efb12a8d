// Settings: defaults come from the table, wrong values are refused with a reason, wrong reads are faults of ours.
#include "core/setting/settings.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "core/numeric/not_finite.hpp"
#include "core/text/diagnostic.hpp"

using namespace sysid;

namespace {
constexpr SettingRow rows[] = {
    {"samples", SettingKind::integer, "25000", 1, infinity, "", "iterations"},
    {"stop", SettingKind::real, "1e-4", 0, 1, "", "threshold"},
    {"proposal", SettingKind::word, "adaptive", 0, 0, "adaptive spherical", "moves"},
    {"polish", SettingKind::flag, "yes", 0, 0, "", "polish"},
    {"scale", SettingKind::real, "0", 0, 1e3, "", "0: chosen", 1e-3},
    {"place", SettingKind::real, "0", -1, 1, "", ""},
};
}  // namespace

TEST_CASE("settings start at the defaults of their table") {
  Settings const settings{rows};
  CHECK(settings.integer("samples") == 25000);
  CHECK(settings.real("samples") == 25000.0);
  CHECK(settings.real("stop") == 1e-4);
  CHECK(settings.word("proposal") == "adaptive");
  CHECK(settings.flag("polish"));
  CHECK(settings.all().size() == 6);
}

TEST_CASE("a setting that is given replaces its default") {
  Settings settings{rows};
  settings.set("samples", std::int64_t{10});
  CHECK(settings.integer("samples") == 10);
  CHECK(settings != Settings{rows});
}

TEST_CASE("a setting read by a wrong name or kind is a fault of ours") {
  Settings const settings{rows};
  CHECK_THROWS_AS(settings.integer("sample"), InternalError);
  CHECK_THROWS_AS(settings.integer("stop"), InternalError);
  CHECK_THROWS_AS(settings.real("proposal"), InternalError);
  CHECK_THROWS_AS(settings.word("polish"), InternalError);
  CHECK_THROWS_AS(settings.flag("samples"), InternalError);
  constexpr SettingRow unreadable[] = {{"samples", SettingKind::integer, "many", 1, 2, "", ""}};
  CHECK_THROWS_AS(Settings{unreadable}, InternalError);
}

TEST_CASE("values outside a setting's range, kind or choices are refused with the reason") {
  CHECK(refuse(rows[0], std::int64_t{1}).empty());
  CHECK(refuse(rows[0], std::int64_t{0}) == "it must be a whole number of at least 1");
  CHECK(refuse(rows[0], 2.5) == "it must be a whole number of at least 1");
  CHECK(refuse(rows[1], std::int64_t{1}).empty());
  CHECK(refuse(rows[1], 1.5) == "it must be a number from 0 to 1");
  CHECK(refuse(rows[1], std::numeric_limits<double>::quiet_NaN()) == "it must be a number from 0 to 1");
  CHECK(refuse(rows[2], std::string("spherical")).empty());
  CHECK(refuse(rows[2], std::string("spheric")) == "it must be one of: adaptive spherical");
  CHECK_FALSE(refuse(rows[2], std::string()).empty());
  CHECK(refuse(rows[3], true).empty());
  CHECK(refuse(rows[4], 0.0).empty());
  CHECK(refuse(rows[4], 1e-3).empty());
  CHECK(refuse(rows[4], 1e-4) == "it must be a number, 0 or from 0.001 to 1000");
  CHECK(refuse(rows[5], -0.5).empty());
  CHECK_FALSE(refuse(rows[3], std::string("true")).empty());
}

TEST_CASE("settings are found by name") {
  REQUIRE(find_setting(rows, "stop"));
  CHECK(find_setting(rows, "stop")->fallback == "1e-4");
  CHECK(find_setting(rows, "halt") == nullptr);
}
