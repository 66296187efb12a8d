// Units of measurement as values: a dimension over the seven SI bases, a scale to the coherent SI unit and, for temperatures, an
// offset. Unit *expressions* are parsed by the language; this file knows atoms (through UDUNITS-2) and their algebra.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

/// Exact small fraction, for exponents such as 1/2. Always reduced, denominator > 0.
struct Rational {
  int numerator = 0;
  int denominator = 1;
  friend bool operator==(Rational const&, Rational const&) = default;
};
Rational operator+(Rational a, Rational b);
Rational operator-(Rational a, Rational b);
Rational operator*(Rational a, Rational b);
/// The fraction equal to x with a denominator up to 64, or nothing.
std::optional<Rational> to_rational(double x);

/// kg, m, s, A, K, mol, cd. Plane angle is dimensionless, as in the SI.
using Dimension = std::array<Rational, 7>;

struct Unit {
  Dimension dimension{};
  double scale = 1;   // 1 of this unit = scale coherent SI units
  double offset = 0;  // zero of this unit, in coherent SI units: 273.15 for degC
  std::string text;   // as the user wrote it, without brackets; empty for a derived unit
  Rational radian{};  // exponent of the radian (rpm and rad/s: 1) and of the hertz: both are 1/s to the SI, 2 pi apart to the user
  Rational hertz{};

  bool dimensionless() const { return dimension == Dimension{}; }
  /// What stands beside its numbers: the text, or of a derived unit what it is in the SI bases.
  std::string text_or_dimension() const;
};

/// A unit name with an optional SI prefix ("N", "mm", "percent", "degC", "delta_degC", "-" for dimensionless), or nothing when
/// unknown. Prefixes go with SI units and their like only, so that "mph" is unknown and not a milliphot. `text` is the name.
/// Thread-safe. IoError when the unit database of UDUNITS-2 cannot be read.
std::optional<Unit> unit_atom(std::string_view name);
/// Names near a misspelt atom, for "did you mean".
std::vector<std::string> const& common_unit_names();

/// Products and powers are of intervals: an offset is dropped, but for the factor 1 and the power 1, which change nothing.
Unit multiply(Unit const& a, Unit const& b);
Unit divide(Unit const& a, Unit const& b);
Unit power(Unit const& a, Rational exponent);

/// The unit itself where it has a text, else the coherent SI unit of its dimension, which is what is written beside numbers then.
Unit named_or_coherent(Unit unit);

/// The number in unit `to` of the quantity that is `value` in unit `from`, offsets applied (20 degC = 293.15 K).
/// Dimensions must agree (the caller has checked).
double convert(double value, Unit const& from, Unit const& to);

/// Whether one counts cycles and the other radians ([Hz] and [rad/s], [Hz] and [rpm]): `convert` has factor 1 there, as the SI has,
/// where the user means 2 pi; or [rpm] and [1/min], where it has 2 pi and the user means 1. Such a conversion must be refused.
bool cycles_against_radians(Unit const& a, Unit const& b);

/// The unit of what lies between two quantities in `unit`: without a zero point, [delta_degC] for [degC].
Unit difference(Unit unit);
/// Whether it is called so: the only mark that such a unit has, as its dimension and scale are those of the other.
bool is_named_difference(Unit const& unit);

/// Whether one has a zero point and the other measures differences of temperature ([delta_degC], or a product): neither converts to
/// the other. [K] measures both.
bool zero_against_difference(Unit const& a, Unit const& b);

/// Canonical SI text, readable as a unit expression: "kg m/s^2", "kg/(m s^2)", "m^(1/2)"; "1" when dimensionless.
std::string format_dimension(Dimension const& dimension);

}  // namespace sysid
