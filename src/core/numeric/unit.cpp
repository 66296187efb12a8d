// Units through UDUNITS-2: its database gives the atoms, this file the prefixes it may carry, the algebra, and what it does not
// know.
#include "core/numeric/unit.hpp"

#include <fmt/format.h>
#include <locale.h>
#include <udunits2.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <numbers>
#include <numeric>
#include <span>

#include "core/numeric/elementary.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using UdUnit = std::unique_ptr<ut_unit, FreeUnit>;

struct Prefix {
  std::string_view symbol, name;
  double factor;
};
constexpr Prefix prefixes[] = {{"Q", "quetta", 1e30}, {"R", "ronna", 1e27},  {"Y", "yotta", 1e24},  {"Z", "zetta", 1e21},
                               {"E", "exa", 1e18},    {"P", "peta", 1e15},   {"T", "tera", 1e12},   {"G", "giga", 1e9},
                               {"M", "mega", 1e6},    {"k", "kilo", 1e3},    {"h", "hecto", 1e2},   {"da", "deca", 1e1},
                               {"d", "deci", 1e-1},   {"c", "centi", 1e-2},  {"m", "milli", 1e-3},  {"u", "micro", 1e-6},
                               {"\u00b5", "", 1e-6},  {"\u03bc", "", 1e-6},  {"n", "nano", 1e-9},   {"p", "pico", 1e-12},
                               {"f", "femto", 1e-15}, {"a", "atto", 1e-18},  {"z", "zepto", 1e-21}, {"y", "yocto", 1e-24},
                               {"r", "ronto", 1e-27}, {"q", "quecto", 1e-30}};

constexpr std::string_view prefixed_symbols[] = {"m",  "g",  "s",   "A", "K", "mol",    "cd",     "rad", "sr", "Hz", "N", "Pa",
                                                 "J",  "W",  "C",   "V", "F", "\u03a9", "\u2126", "S",   "Wb", "T",  "H", "lm",
                                                 "lx", "Bq", "kat", "L", "l", "t",      "eV",     "Gy",  "Sv", "VA"};
constexpr std::string_view prefixed_names[] = {
    "metre",  "metres",  "meter", "meters", "gram",    "grams",   "second",  "seconds",  "ampere", "amperes",
    "kelvin", "kelvins", "mole",  "moles",  "candela", "radian",  "radians", "hertz",    "newton", "newtons",
    "pascal", "pascals", "joule", "joules", "watt",    "watts",   "coulomb", "coulombs", "volt",   "volts",
    "farad",  "farads",  "ohm",   "ohms",   "Ohm",     "siemens", "weber",   "webers",   "tesla",  "teslas",
    "henry",  "lumen",   "lux",   "litre",  "litres",  "liter",   "liters",  "bar",      "bars",   "becquerel"};

constexpr std::string_view names_with_symbol_prefix[] = {"bar", "ohm", "Ohm"};

/// Names that users write and UDUNITS-2 lacks.
struct Extra {
  std::string_view name;
  std::string_view database_name;  // empty: dimensionless, but for the factor
  double factor;
  bool interval;  // drop the offset
};
constexpr Extra extras[] = {{"-", "", 1, false},
                            {"1", "", 1, false},
                            {"strain", "", 1, false},
                            {"microstrain", "", 1e-6, false},
                            {"deg", "arc_degree", 1, false},
                            {"rev", "revolution", 1, false},
                            {"g_n", "gravity", 1, false},
                            {"mg_n", "gravity", 1e-3, false},
                            {"ug_n", "gravity", 1e-6, false},
                            {"Wh", "watthour", 1, false},
                            {"delta_degC", "degC", 1, true},
                            {"delta_degF", "degF", 1, true}};

constexpr std::string_view base_symbols[] = {"kg", "m", "s", "A", "K", "mol", "cd"};

std::mutex& database_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// Numbers with a decimal point in this thread, whatever the locale of the program that uses this library: UDUNITS reads `0.3048`
/// by the locale.
class PlainNumbers {
 public:
  PlainNumbers() : own_(::newlocale(LC_ALL_MASK, "C", nullptr)), before_(own_ ? ::uselocale(own_) : nullptr) {}
  ~PlainNumbers() {
    if (before_) ::uselocale(before_);
    if (own_) ::freelocale(own_);
  }
  PlainNumbers(PlainNumbers const&) = delete;

 private:
  locale_t own_, before_;
};

/// The database, read once; the caller holds the mutex.
ut_system& database() {
  static std::unique_ptr<ut_system, void (*)(ut_system*)> const system = [] {
    ut_set_error_message_handler(ut_ignore);  // it would print to stderr otherwise
    PlainNumbers const numbers;
    std::unique_ptr<ut_system, void (*)(ut_system*)> read(ut_read_xml(nullptr), ut_free_system);
    if (!read) throw IoError("cannot read the unit database of UDUNITS-2 (udunits2.xml); set UDUNITS2_XML_PATH to its path");
    return read;
  }();
  return *system;
}

bool add_basic(Unit& unit, ut_unit const* basic, int power) {
  char const* const symbol = ut_get_symbol(basic, UT_ASCII);
  if (symbol == nullptr) return false;
  for (std::size_t i = 0; i < std::size(base_symbols); ++i) {
    if (base_symbols[i] == symbol) {
      unit.dimension[i] = unit.dimension[i] + Rational{power, 1};
      return true;
    }
  }
  if (std::string_view(symbol) != "rad") return false;
  unit.radian = unit.radian + Rational{power, 1};
  return true;
}

ut_status visit_basic(ut_unit const* basic, void* out) {
  return add_basic(*static_cast<Unit*>(out), basic, 1) ? UT_SUCCESS : UT_VISIT_ERROR;
}

ut_status visit_product(ut_unit const*, int count, ut_unit const* const* basics, int const* powers, void* out) {
  for (int i = 0; i < count; ++i)
    if (!add_basic(*static_cast<Unit*>(out), basics[i], powers[i])) return UT_VISIT_ERROR;
  return UT_SUCCESS;
}

ut_status visit_timestamp(ut_unit const*, ut_unit const*, double, void*) { return UT_VISIT_ERROR; }
ut_status visit_logarithmic(ut_unit const*, double, ut_unit const*, void*) { return UT_VISIT_ERROR; }
ut_status visit_galilean(ut_unit const*, double scale, ut_unit const* underlying, double offset, void* out);

constexpr ut_visitor visitor{visit_basic, visit_product, visit_galilean, visit_timestamp, visit_logarithmic};

/// UDUNITS-2: value in `underlying` = scale (value + offset).
ut_status visit_galilean(ut_unit const*, double scale, ut_unit const* underlying, double offset, void* out) {
  Unit& unit = *static_cast<Unit*>(out);
  unit.offset += unit.scale * scale * offset;
  unit.scale *= scale;
  return ut_accept_visitor(underlying, &visitor, out);
}

std::optional<Unit> read(UdUnit const& found) {
  Unit unit;
  if (!found || ut_accept_visitor(found.get(), &visitor, &unit) != UT_SUCCESS) return std::nullopt;
  return unit;
}

std::optional<Unit> by_symbol(std::string const& symbol) {
  std::optional<Unit> unit = read(UdUnit(ut_get_unit_by_symbol(&database(), symbol.c_str())));
  if (unit && (symbol == "Hz" || symbol == "cps")) unit->hertz = {1, 1};
  return unit;
}

/// Names, unlike symbols, are found in any case.
bool is_hertz(std::string_view name) {
  constexpr std::string_view hertz = "hertz";
  return std::equal(name.begin(), name.end(), hertz.begin(), hertz.end(), [](char a, char b) { return (a | 0x20) == b; });
}

std::optional<Unit> by_name(std::string const& name) {
  std::optional<Unit> unit = read(UdUnit(ut_get_unit_by_name(&database(), name.c_str())));
  if (unit && is_hertz(name)) unit->hertz = {1, 1};
  return unit;
}

/// The database's own unit of this name, without prefix.
std::optional<Unit> plain(std::string const& name) {
  if (std::optional<Unit> const unit = by_symbol(name)) return unit;
  return by_name(name);
}

std::optional<Unit> extra(std::string_view name) {
  for (Extra const& row : extras) {
    if (row.name != name) continue;
    std::optional<Unit> unit = row.database_name.empty() ? Unit{} : plain(std::string(row.database_name));
    if (!unit) return std::nullopt;
    unit->scale *= row.factor;
    if (row.interval) unit->offset = 0;
    return unit;
  }
  return std::nullopt;
}

bool contains(std::span<std::string_view const> list, std::string_view item) {
  return std::find(list.begin(), list.end(), item) != list.end();
}

std::optional<Unit> prefixed(std::string_view name) {
  for (Prefix const& prefix : prefixes) {
    std::optional<Unit> unit;
    std::string const after_symbol(name.starts_with(prefix.symbol) ? name.substr(prefix.symbol.size()) : "");
    std::string const after_name(!prefix.name.empty() && name.starts_with(prefix.name) ? name.substr(prefix.name.size()) : "");
    if (contains(prefixed_symbols, after_symbol)) unit = by_symbol(after_symbol);
    if (!unit && contains(names_with_symbol_prefix, after_symbol)) unit = by_name(after_symbol);
    if (!unit && contains(prefixed_names, after_name)) unit = by_name(after_name);
    if (!unit) continue;
    unit->scale *= prefix.factor;
    return unit;
  }
  return std::nullopt;
}

Rational reduced(std::int64_t numerator, std::int64_t denominator) {
  if (denominator < 0) {
    numerator = -numerator;
    denominator = -denominator;
  }
  std::int64_t const divisor = std::gcd(numerator, denominator);
  return {static_cast<int>(numerator / divisor), static_cast<int>(denominator / divisor)};
}

bool is_one(Unit const& unit) {
  return unit.dimensionless() && unit.scale == 1 && unit.offset == 0 && unit.radian == Rational{} && unit.hertz == Rational{};
}

/// x^(n/d): exact products for whole exponents, sqrt for halves, so that no processor's pow enters the common units.
double power(double x, Rational exponent) {
  if (exponent.denominator > 2) return elementary::pow(x, static_cast<double>(exponent.numerator) / exponent.denominator);
  double const base = exponent.denominator == 2 ? std::sqrt(x) : x;
  double result = 1;
  for (int i = 0; i < std::abs(exponent.numerator); ++i) result *= base;
  return exponent.numerator < 0 ? 1 / result : result;
}

std::string format_power(std::string_view symbol, Rational exponent) {
  if (exponent == Rational{1, 1}) return std::string(symbol);
  if (exponent.denominator == 1) return fmt::format("{}^{}", symbol, exponent.numerator);
  return fmt::format("{}^({}/{})", symbol, exponent.numerator, exponent.denominator);
}

}  // namespace

Rational operator+(Rational a, Rational b) {
  return reduced(std::int64_t{a.numerator} * b.denominator + std::int64_t{b.numerator} * a.denominator,
                 std::int64_t{a.denominator} * b.denominator);
}

Rational operator-(Rational a, Rational b) { return a + Rational{-b.numerator, b.denominator}; }

Rational operator*(Rational a, Rational b) {
  return reduced(std::int64_t{a.numerator} * b.numerator, std::int64_t{a.denominator} * b.denominator);
}

std::optional<Rational> to_rational(double x) {
  constexpr double largest = 1e6;  // an exponent beyond is a mistake, and would not fit
  if (!(std::fabs(x) <= largest)) return std::nullopt;
  for (int denominator = 1; denominator <= 64; ++denominator) {
    double const numerator = std::round(x * denominator);
    if (std::fabs(x * denominator - numerator) <= 1e-9) return reduced(static_cast<std::int64_t>(numerator), denominator);
  }
  return std::nullopt;
}

std::optional<Unit> unit_atom(std::string_view name) {
  if (name.empty() || name.find('\0') != std::string_view::npos) return std::nullopt;
  std::lock_guard const lock(database_mutex());
  std::optional<Unit> unit = extra(name);
  if (!unit) unit = plain(std::string(name));
  if (!unit) unit = prefixed(name);
  if (unit) unit->text = name;
  return unit;
}

std::vector<std::string> const& common_unit_names() {
  static std::vector<std::string> const names = {
      "m",      "mm",    "cm",          "km",      "um",       "kg",   "g",      "t",      "s",          "ms",     "us",
      "min",    "h",     "day",         "A",       "mA",       "K",    "degC",   "degF",   "delta_degC", "mol",    "cd",
      "rad",    "mrad",  "deg",         "rev",     "Hz",       "kHz",  "MHz",    "rpm",    "N",          "kN",     "MN",
      "Pa",     "kPa",   "MPa",         "GPa",     "bar",      "psi",  "J",      "kJ",     "W",          "kW",     "MW",
      "C",      "V",     "mV",          "kV",      "F",        "uF",   "ohm",    "kohm",   "S",          "Wb",     "T",
      "H",      "mH",    "L",           "percent", "ppm",      "g_n",  "lb",     "lbf",    "in",         "ft",     "newton",
      "pascal", "metre", "meter",       "second",  "kilogram", "volt", "ampere", "kelvin", "radian",     "degree", "hertz",
      "joule",  "watt",  "microstrain", "slug",    "kip",      "hour", "minute", "inch",   "tonne",      "litre"};
  return names;
}

Unit multiply(Unit const& a, Unit const& b) {
  if (is_one(a)) return b;
  if (is_one(b)) return a;
  Unit product;
  for (std::size_t i = 0; i < product.dimension.size(); ++i) product.dimension[i] = a.dimension[i] + b.dimension[i];
  product.scale = a.scale * b.scale;
  product.radian = a.radian + b.radian;
  product.hertz = a.hertz + b.hertz;
  return product;
}

Unit divide(Unit const& a, Unit const& b) {
  if (is_one(b)) return a;
  Unit quotient;
  for (std::size_t i = 0; i < quotient.dimension.size(); ++i) quotient.dimension[i] = a.dimension[i] - b.dimension[i];
  quotient.scale = a.scale / b.scale;
  quotient.radian = a.radian - b.radian;
  quotient.hertz = a.hertz - b.hertz;
  return quotient;
}

Unit power(Unit const& a, Rational exponent) {
  if (exponent == Rational{1, 1}) return a;
  Unit result;
  for (std::size_t i = 0; i < result.dimension.size(); ++i) result.dimension[i] = a.dimension[i] * exponent;
  result.scale = power(a.scale, exponent);
  result.radian = a.radian * exponent;
  result.hertz = a.hertz * exponent;
  return result;
}

Unit named_or_coherent(Unit unit) {
  if (unit.text.empty()) unit.scale = 1;
  return unit;
}

double convert(double value, Unit const& from, Unit const& to) {
  if (from.scale == to.scale && from.offset == to.offset) return value;  // no rounding where nothing changes
  return (value * from.scale + (from.offset - to.offset)) / to.scale;
}

bool cycles_against_radians(Unit const& a, Unit const& b) {
  if (a.radian == b.radian) return false;
  if (!(a.hertz == b.hertz)) return true;
  // What turns 3000 times in a minute has 3000 rpm, 2 pi/60 rad/s each, and 3000 1/min.
  double const ratio = std::fabs(elementary::log(a.scale / b.scale));
  return a.dimension == b.dimension && std::fabs(ratio - elementary::log(2 * std::numbers::pi)) < 1e-9;
}

Unit difference(Unit unit) {
  if (unit.offset == 0) return unit;
  unit.offset = 0;
  unit.text = "delta_" + unit.text;
  if (!unit_atom(unit.text)) unit.text = unit.scale == 1 ? "K" : "delta_degF";
  if (auto const named = unit_atom(unit.text); !named || named->scale != unit.scale) unit.text.clear();
  return unit;
}

bool is_named_difference(Unit const& unit) { return unit.text.starts_with("delta_"); }

bool zero_against_difference(Unit const& a, Unit const& b) {
  auto const measures_differences = [](Unit const& unit) {
    return unit.offset == 0 && (unit.text.empty() || is_named_difference(unit));
  };
  return a.dimension == b.dimension && ((a.offset != 0 && measures_differences(b)) || (b.offset != 0 && measures_differences(a)));
}

std::string Unit::text_or_dimension() const { return text.empty() ? format_dimension(dimension) : text; }

std::string format_dimension(Dimension const& dimension) {
  std::string above, below;
  int factors_below = 0;
  for (std::size_t i = 0; i < dimension.size(); ++i) {
    Rational const exponent = dimension[i];
    if (exponent.numerator == 0) continue;
    bool const positive = exponent.numerator > 0;
    std::string& text = positive ? above : below;
    if (!text.empty()) text += ' ';
    text += format_power(base_symbols[i], {std::abs(exponent.numerator), exponent.denominator});
    if (!positive) ++factors_below;
  }
  if (above.empty()) above = "1";
  if (factors_below == 0) return above;
  return factors_below == 1 ? above + "/" + below : above + "/(" + below + ")";
}

}  // namespace sysid
