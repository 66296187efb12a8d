// Units at the end of names, and names that only end like one.
#include "data/cell/column_name.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace sysid;

TEST_CASE("a unit behind the last underscore is one, in a struct, and with the underscores that MATLAB makes of brackets") {
  for (auto const& [column, unit] :
       {std::pair("Kraft_kN", "kN"), std::pair("run.Weg_LVDT_mm_", "mm"), std::pair("Messung_03.t_ms", "ms"),
        std::pair("time_us", "us"), std::pair("Zeit__s_", "s"), std::pair("t_min", "min"), std::pair("T_degC", "degC"),
        std::pair("M_Nm", "N m"), std::pair("run/p_MPa", "MPa"), std::pair("n_rpm", "rpm")}) {
    CAPTURE(column);
    auto const found = unit_behind_underscore(column);
    REQUIRE(found);
    CHECK(found->unit == unit);
    CHECK(unit_of_text(found->unit));
  }
}

TEST_CASE("indices, kinds and letters behind an underscore are no units") {
  for (char const* const column : {"x_m",  "a_g",   "k_1",   "pos_x", "signal_h", "F_N",   "x_cm",    "p_bar",   "a_rad",
                                   "F_in", "y_min", "x_max", "x_s",   "u_ref",    "T_s",   "T_h",     "T_min",   "TS_min",
                                   "mm",   "_mm",   "kN",    "Kraft", "x_ms",     "acc_h", "phi_deg", "m_total", "x_mm2"}) {
    CAPTURE(column);
    CHECK_FALSE(unit_behind_underscore(column));
  }
}

TEST_CASE("the time is called so with a unit as well") {
  for (char const* const column : {"t", "time", "Zeit (ms)", "Messung_03.t_ms", "time_ms", "Zeit_ms", "t_s", "run/time",
                                   "Time [min]", "millis", "Zeit 1 - Standardmessrate"})
    CHECK_MESSAGE(is_time_name(column), column);
  for (char const* const column : {"x_ms", "t_kN", "temp", "ramp_ms", "y", "T_s", "T_h", "run.T_min"})
    CHECK_MESSAGE(!is_time_name(column), column);
}

TEST_CASE("columns of accelerations are told from others, whose g and mg are masses") {
  for (char const* const column : {"acc_x", "Beschl. 3", "a_z [mg]", "ax (g)", "A", "imu.a_y", "G Force Lat"})
    CHECK_MESSAGE(is_acceleration_name(column), column);
  for (char const* const column : {"dose [mg]", "m [g]", "max", "amp", "a_lpha", "mass_a"})
    CHECK_MESSAGE(!is_acceleration_name(column), column);
  CHECK(unit_behind_underscore("millis")->unit == "ms");
}
