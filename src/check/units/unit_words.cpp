// Two small tables: named units that make a dimension short, and the kinds of quantities that have a name.
#include "check/units/unit_words.hpp"

#include <cstdlib>
#include <optional>
#include <utility>

namespace sysid {
namespace {

struct Exponents {
  int kg, m, s, A, K;
  Dimension dimension() const { return {{{kg, 1}, {m, 1}, {s, 1}, {A, 1}, {K, 1}, {0, 1}, {0, 1}}}; }
};

// A unit that takes part in products (newton per metre, kelvin per watt) or stands alone only (nobody calls N/m^3 pascal per
// metre).
struct Named {
  std::string_view symbol;
  Exponents exponents;
  bool in_products;
};
constexpr Named named_units[] = {
    {"N", {1, 1, -2, 0, 0}, true},     {"V", {1, 2, -3, -1, 0}, true},   {"W", {1, 2, -3, 0, 0}, true},
    {"J", {1, 2, -2, 0, 0}, false},    {"Pa", {1, -1, -2, 0, 0}, false}, {"C", {0, 0, 1, 1, 0}, false},
    {"ohm", {1, 2, -3, -2, 0}, false}, {"F", {-1, -2, 4, 2, 0}, false},  {"H", {1, 2, -2, -2, 0}, false},
    {"T", {1, 0, -2, -1, 0}, false},   {"Wb", {1, 2, -2, -1, 0}, false},
};

struct NamedKind {
  std::string_view name;
  Exponents exponents;
  bool plain = false;
};
constexpr NamedKind named_kinds[] = {
    {"a length", {0, 1, 0, 0, 0}, true},
    {"a time", {0, 0, 1, 0, 0}, true},
    {"a mass", {1, 0, 0, 0, 0}, true},
    {"a current", {0, 0, 0, 1, 0}, true},
    {"a temperature", {0, 0, 0, 0, 1}, true},
    {"an area", {0, 2, 0, 0, 0}, true},
    {"a volume", {0, 3, 0, 0, 0}, true},
    {"a velocity", {0, 1, -1, 0, 0}, true},
    {"an acceleration", {0, 1, -2, 0, 0}},
    {"a force", {1, 1, -2, 0, 0}, true},
    {"a stiffness", {1, 0, -2, 0, 0}},
    {"a pressure", {1, -1, -2, 0, 0}},
    {"an energy", {1, 2, -2, 0, 0}},
    {"a power", {1, 2, -3, 0, 0}},
    {"a voltage", {1, 2, -3, -1, 0}, true},
    {"a resistance", {1, 2, -3, -2, 0}},
    {"a charge", {0, 0, 1, 1, 0}},
    {"a rate", {0, 0, -1, 0, 0}, true},
    {"a mass density", {1, -3, 0, 0, 0}},
    {"a momentum", {1, 1, -1, 0, 0}},
};

constexpr std::size_t kilogram = 0, second = 2;
constexpr std::string_view prefixes = "GMkhdcmun";

int exponents_of(Dimension const& dimension) {
  int size = 0;
  for (Rational const& exponent : dimension)
    if (exponent.numerator != 0) size += 1 + std::abs(exponent.numerator) + exponent.denominator - 1;
  return size;
}

// "N s/m" from a named unit above or below the bar and what is left.
std::string joined(std::string_view name, int power, Dimension const& rest) {
  std::string const symbol = std::string(name) + (std::abs(power) > 1 ? "^" + std::to_string(std::abs(power)) : "");
  std::string const base = format_dimension(rest);
  std::string above = base.substr(0, base.find('/')),
              below = base.find('/') == std::string::npos ? "" : base.substr(base.find('/') + 1);
  if (power > 0) return symbol + (above == "1" ? "" : " " + above) + (below.empty() ? "" : "/" + below);
  if (!below.empty() && below.front() == '(') below = below.substr(1, below.size() - 2);
  return above + "/" + (below.empty() ? symbol : "(" + symbol + " " + below + ")");
}

std::string short_dimension(Dimension const& dimension, UnitNames const& in_use) {
  for (Named const& named : named_units)
    if (in_use.contains(named.symbol) && named.exponents.dimension() == dimension) return std::string(named.symbol);
  std::string text = format_dimension(dimension);
  // Who writes newtons reads "N s/m" more easily than "kg/s".
  int size = exponents_of(dimension) + (in_use.contains("N") && dimension[second].numerator != 0 ? 3 : 0);
  for (Named const& named : named_units)
    for (int const power : {1, -1, 2, -2, 3, -3, 4, -4}) {
      if (!named.in_products || !in_use.contains(named.symbol)) continue;
      Dimension rest = dimension;
      for (int k = 0; k < std::abs(power); ++k)
        rest = quotient(rest, power > 0 ? named.exponents.dimension() : inverse(named.exponents.dimension()));
      // A newton stands for the kilogram in it: m/s^2 is not N/kg.
      bool const brings_mass = std::abs(rest[kilogram].numerator) > std::abs(dimension[kilogram].numerator);
      int const length = 1 + std::abs(power) + exponents_of(rest);
      if (brings_mass || length >= size) continue;
      size = length;
      text = joined(named.symbol, power, rest);
    }
  return text;
}

bool is_unit_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

}  // namespace

Dimension quotient(Dimension const& a, Dimension const& b) {
  Dimension result;
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = a[i] - b[i];
  return result;
}
Dimension inverse(Dimension const& dimension) { return quotient(Dimension{}, dimension); }

void add_unit_names(std::string_view text, UnitNames& names) {
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    while (end < text.size() && is_unit_letter(text[end])) ++end;
    std::string_view const word = text.substr(at, end - at);
    for (Named const& named : named_units) {
      bool const prefixed = word.size() == named.symbol.size() + 1 && word.ends_with(named.symbol) &&
                            prefixes.find(word[0]) != std::string_view::npos;
      if (word == named.symbol || prefixed) names.emplace(named.symbol);
    }
    at = end + (end == at ? 1 : 0);
  }
}

std::string unit_words(Unit const& unit, UnitNames const& in_use) {
  if (!unit.text.empty()) return unit.text;
  Dimension const rate = Exponents{0, 0, -1, 0, 0}.dimension();
  bool const cycles = unit.hertz == Rational{1, 1}, radians = unit.radian == Rational{1, 1};
  if (unit.dimension == rate && (cycles || radians)) return cycles ? "Hz" : "rad/s";
  if (unit.dimensionless()) return cycles ? "cycles" : radians ? "rad" : "-";
  return short_dimension(unit.dimension, in_use);
}

bool is_plain_kind(Dimension const& dimension) {
  for (NamedKind const& kind : named_kinds)
    if (kind.plain && kind.exponents.dimension() == dimension) return true;
  return false;
}

std::string kind_words(Dimension const& dimension, UnitNames const& in_use) {
  for (NamedKind const& kind : named_kinds)
    if (kind.exponents.dimension() == dimension) return std::string(kind.name);
  return "something in [" + short_dimension(dimension, in_use) + "]";
}

}  // namespace sysid
