// By lists of names and of units; a name that is on none says nothing.
#include "data/cell/column_name.hpp"

#include <algorithm>
#include <iterator>

namespace sysid {
namespace {

struct NamedUnit {
  std::string_view written, meant;
};
constexpr NamedUnit units_of_times[] = {{"ns", "ns"}, {"us", "us"}, {"usec", "us"}, {"ms", "ms"}, {"msec", "ms"},
                                        {"s", "s"},   {"sec", "s"}, {"min", "min"}, {"h", "h"}};
constexpr NamedUnit units[] = {{"mm", "mm"},     {"um", "um"},   {"km", "km"},    {"kN", "kN"},   {"mN", "mN"},     {"MN", "MN"},
                               {"lbf", "lbf"},   {"Nm", "N m"},  {"kNm", "kN m"}, {"kPa", "kPa"}, {"MPa", "MPa"},   {"hPa", "hPa"},
                               {"mbar", "mbar"}, {"psi", "psi"}, {"Hz", "Hz"},    {"kHz", "kHz"}, {"mV", "mV"},     {"kV", "kV"},
                               {"uV", "uV"},     {"mA", "mA"},   {"uA", "uA"},    {"kW", "kW"},   {"degC", "degC"}, {"rpm", "rpm"},
                               {"mrad", "mrad"}, {"kg", "kg"},   {"kmh", "km/h"}};

std::string in_small_letters_only(std::string_view name) {
  std::string small;
  for (char const c : name)
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) small += static_cast<char>(c | 0x20);
  return small;
}

bool is_word_of_time(std::string_view name) {
  std::string const small = in_small_letters_only(name);
  for (std::string_view const each : {"t",
                                      "time",
                                      "zeit",
                                      "timestamp",
                                      "datetime",
                                      "date",
                                      "uhrzeit",
                                      "datum",
                                      "xvalue",
                                      "xaxis",
                                      "elapsedtime",
                                      "seconds",
                                      "sec",
                                      "temps",
                                      "tiempo",
                                      "tid",
                                      "zeitstempel",
                                      "ts",
                                      "epoch",
                                      "unixtime",
                                      "utc",
                                      "utctime",
                                      "hhmm",
                                      "hhmmss",
                                      "gpstime",
                                      "zeitstandardmessrate",
                                      "timedefaultsamplerate",
                                      "millis",
                                      "micros"})
    if (small == each) return true;
  return false;
}

/// Without the structs or groups that it is in.
std::string_view last_part(std::string_view column) { return column.substr(column.find_last_of("./") + 1); }

/// `T_s`, `T_h`, `T_min`, `TS_max`: of a surface, hot, the lowest; `t_s` is a time.
bool is_kind_of_temperature(std::string_view column) {
  return last_part(column).starts_with("T_") || last_part(column).starts_with("TS_");
}

}  // namespace

std::optional<NameWithUnit> unit_behind_underscore(std::string_view column) {
  std::string_view name = last_part(column);
  // Functions of Arduino, whose names are units.
  if (name == "millis") return NameWithUnit{"millis", "ms"};
  if (name == "micros") return NameWithUnit{"micros", "us"};
  while (name.ends_with('_')) name.remove_suffix(1);
  std::size_t const at = name.rfind('_');
  if (at == std::string_view::npos) return std::nullopt;
  std::string_view const end = name.substr(at + 1);
  name = name.substr(0, at);
  while (name.ends_with('_')) name.remove_suffix(1);
  if (name.empty()) return std::nullopt;
  if (!is_kind_of_temperature(column) && is_word_of_time(name))
    for (NamedUnit const& each : units_of_times)
      if (end == each.written) return NameWithUnit{std::string(name), std::string(each.meant)};
  for (NamedUnit const& each : units)
    if (end == each.written) return NameWithUnit{std::string(name), std::string(each.meant)};
  return std::nullopt;
}

std::optional<std::string_view> unit_of_time_name(std::string_view column) {
  struct UnitWords {
    std::string_view unit, spellings;
  };
  constexpr UnitWords rows[] = {{"ms", " ms millisecond milliseconds millisekunde millisekunden "},
                                {"s", " s sec secs second seconds sekunde sekunden "},
                                {"min", " min mins minute minutes minuten "},
                                {"h", " h hr hrs hour hours stunde stunden "},
                                {"day", " day days tag tage "},
                                {"year", " year years yr yrs jahr jahre "}};
  constexpr std::size_t shortest_ending = 4;  // `run_s`, `t_min`: what stands behind a shorter one decides (above)
  std::string_view const whole = last_part(column);
  std::string_view const ending = whole.substr(whole.find_last_of("_ ") + 1);
  std::string_view const name = ending.size() < whole.size() && ending.size() >= shortest_ending ? ending : whole;
  std::string const word = " " + in_small_letters_only(name) + " ";
  for (UnitWords const& row : rows)
    if (row.spellings.find(word) != std::string_view::npos) return row.unit;
  return std::nullopt;
}

bool is_time_name(std::string_view column) {
  if (is_kind_of_temperature(column)) return false;
  if (auto const split = split_name(column)) return is_word_of_time(split->name);
  if (is_word_of_time(last_part(column))) return true;
  auto const ended = unit_behind_underscore(column);
  auto const of_times = [&](NamedUnit const& each) { return each.meant == ended->unit; };
  return ended && is_word_of_time(ended->name) && std::any_of(std::begin(units_of_times), std::end(units_of_times), of_times);
}

bool is_temperature_name(std::string_view column) {
  auto const split = split_name(column);
  return last_part(split ? std::string_view(split->name) : column) == "T";
}

bool is_acceleration_name(std::string_view column) {
  std::string const small = in_small_letters_only(column);
  if (small.starts_with("acc") || small.find("accel") != std::string::npos || small.find("beschl") != std::string::npos ||
      small.starts_with("gforce"))
    return true;
  // `a_z`, `ax`, `a1`, `A (x)`: nobody weighs these.
  auto const split = split_name(column);
  std::string const bare = in_small_letters_only(last_part(split ? split->name : column));
  return bare == "a" || bare == "ax" || bare == "ay" || bare == "az";
}

}  // namespace sysid
