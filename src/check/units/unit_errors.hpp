// The wording of mistakes in units (E2103, E22): named constructors, called by unit_check.cpp alone.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "check/units/unit_check.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {

/// What differs from what, as places with their units.
struct UnitConflict {
  enum class Position { before, after, other_side };  // the odd one stands before or after those it is shown against
  Label primary;
  std::vector<Label> secondary;
  Position position = Position::after;
  bool several = false;       // it is shown against several terms
  std::string found, wanted;  // units
  std::string help;
};

namespace errors {

Diagnostic units_differ(Occasion const& occasion, UnitConflict conflict);
Diagnostic pure_argument(Label argument, std::string const& function, std::string help);
Diagnostic exponent_with_unit(Label exponent, std::string help);
Diagnostic base_with_unit(Label base, Span exponent, std::string const& text, std::string const& unit);
Diagnostic condition_with_unit(Label condition, std::string const& text, bool before_value);
/// A temperature, or a difference of two, where it meets another.
struct Temperature {
  Label label;
  std::string text;  // as written; empty: a declaration
  bool is_name = false, is_number = false;
  Unit unit;
};
Diagnostic zeros_differ(Zeros zeros, Temperature shown, Temperature other);
/// Warnings. counts_cycles: the shown quantity does, the other is in radians. moved: the shown one with its 2*pi on the other side
/// of the fraction, or empty.
Diagnostic cycles_meet_radians(Label shown, Label other, bool counts_cycles, std::string const& moved);
/// name: of the frequency, or empty.
Diagnostic cycles_as_angular(Label shown, Label other, std::string const& name);
Diagnostic cycles_in_angle(Span argument, std::string const& function);
/// Warnings. A bare number beside what is in a dimensionless unit; name: of the constant that it is, "1" for an expression.
Diagnostic number_beside(Span number, Label other, bool angle, std::string const& text, std::string const& unit,
                         std::string const& name);
/// Of a named number without a unit beside what is in `unit`; base: the unit that it has then.
Diagnostic constant_beside(Span constant, Label other, std::string const& name, std::string const& unit, std::string const& base);
/// Of a number in an angle: 45 in `sin(45)`.
Diagnostic degrees_as_radians(Span number, std::string const& function, std::string const& text);
/// The same as the value of what is declared in [rad].
Diagnostic degrees_given_to(Span number, Label declared, std::string const& name, std::string const& text);
/// factor: what the declared unit does already; written: the product without it.
Diagnostic converted_twice(Label shown, Label declared, std::string const& factor, std::string const& unit,
                           std::string const& written);
Diagnostic factor_converted(Span shown, std::string const& factor, std::string const& name, std::string const& unit,
                            std::string const& written);
Diagnostic angle_converted(Span shown, std::string const& factor, std::string const& written);

/// Quantities whose units do not agree, as an error.
bool is_unit_conflict(Diagnostic const& diagnostic);
/// The first of `places` conflicts that another unit of one declaration would resolve.
Diagnostic blamed(Diagnostic conflict, ast::Name const& declared, std::string const& unit, int places);

/// A letter that is a unit of temperature on paper; difference: in products, where only intervals count.
struct LetterUnit {
  char const* letter;
  char const* name;  // of what it is here
  char const* temperature;
  char const* scale;
  char const* difference;
};
inline constexpr LetterUnit letter_units[] = {{"C", "coulomb", "degC", "degrees Celsius", "K"},
                                              {"F", "farad", "degF", "degrees Fahrenheit", "delta_degF"}};
/// written: where the letter stands first.
Diagnostic letter_taken_for_temperature(Diagnostic conflict, Span written, LetterUnit const& letter);
/// A mistake in the body of a function, told at the call.
void move_to_call(Diagnostic& diagnostic, Span call, std::string const& function);

// What to do, for `help`. names: declared quantities that would do ("`y` or `l`"), or empty.
// what: "this", "this term".
std::string multiply_by(std::string_view what, std::string const& kind, std::string const& names);
std::string divide_by(std::string_view what, std::string const& kind, std::string const& names);
/// Elements of a vector share a declaration: `k[2]` is declared as `k`.
std::string declare_in(std::string const& name, std::string const& unit);
/// Help for `1/50 [s]`, where a time of 1/50 is meant.
std::string number_by_quotient(std::string const& written, double number, std::string const& unit);
/// unit: "g" or "mg", where an acceleration is meant.
std::string gram_for_gravity(std::string const& unit);
std::string should_be_in(std::string_view what, std::string const& unit);
/// Of a 0 in another unit.
std::string zero_in(std::string const& unit);
/// Of a noise parameter that something else reads in its unit.
std::string own_width(std::string const& channel, std::string const& unit);
/// name: of what is declared in [g] and taken for an acceleration.
std::string declared_in_grams(std::string const& name);
std::string parentheses_lost(std::string const& written);
/// quotient: as it is written, and turned over; without one the reciprocal alone is named.
std::string reciprocal_meant(std::optional<std::pair<std::string, std::string>> const& quotient, std::string const& unit);
std::string tag_the_number(std::string const& number, std::string const& unit);
/// multiplies: as the text has it; unit: the one that it should have been declared in otherwise.
std::string inverse_meant(std::string const& name, bool multiplies, std::string const& unit);
/// coefficient: the name whose unit may be wrong in place of the primes, and what it would be in; or empty.
std::string primes_wrong(std::string const& name, int primes, int wanted, std::string const& coefficient, std::string const& unit);

}  // namespace errors
}  // namespace sysid
