// What the name of a column says about its numbers: that they are times or accelerations, and in which unit they are.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "data/cell/unit_text.hpp"

namespace sysid {

/// Whether people call the time so: `t`, `Zeit (ms)`, `run.time_ms`.
bool is_time_name(std::string_view column);

/// Whether people call a temperature so that may as well be a time: `T`, `T (C)`.
bool is_temperature_name(std::string_view column);

/// Whether people call an acceleration so, by which `g` behind it is no gram.
bool is_acceleration_name(std::string_view column);

/// `Kraft_kN`, `run.t_ms`, `Weg_mm_`: the name and the unit behind its last underscore, as the language writes it. Only units that
/// nothing else is called after: of several letters, no `cm`, `bar`, `rad`, `in`, `max` (a centre of mass, a mean, a radius, an
/// input, an extreme), and of one letter, and minutes, only behind a name of the time (`t_s`, not `T_s`).
std::optional<NameWithUnit> unit_behind_underscore(std::string_view column);

/// Of a column that is used as the time: the unit that its name is, `hours`, `Minuten`, `elapsed_days`, or `min` and `h`.
std::optional<std::string_view> unit_of_time_name(std::string_view column);

}  // namespace sysid
