// Numbers and units as text: exact for files, rounded to what is known for people.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

/// Power of ten of the leading digit; x finite and not 0.
int decade(double x);
/// Plain notation reads best between the powers of ten for which this is false.
bool needs_exponent(int power);
/// value / 10^exponent with so many decimals, and "e" and the exponent unless that is 0.
std::string with_exponent(double value, int decimals, int exponent);

/// The shortest decimal that reads back as the same double; "NaN", "Inf", "-Inf", as R and Python read them.
std::string shortest(double value);

/// `digits` significant digits, plain or with an exponent, whichever is easier on the eye; "-" when not finite.
std::string significant(double value, int digits);

/// "4.986e9" for a page: "4.986·10⁹".
std::string pretty_number(std::string_view text);

/// The number at the beginning of a text, with a decimal point whatever the locale of the process says; 0 where there is none.
double leading_number(std::string_view text);

/// What follows a number: " m/s"; nothing for "-", which would read as a minus or a missing value.
std::string unit_after_number(std::string_view unit);

/// "N s/m^3" as a reader likes it: "N·s/m³".
std::string pretty_unit(std::string_view unit);

/// Words with units in brackets: "input x = a [m/s^2]" as "input x = a [m/s²]".
std::string pretty_units(std::string_view words);

/// Words with a quantity in them, their powers raised and no more: "sigma 0.472 m/s^2".
std::string pretty_powers(std::string_view words);

/// Superscript digits: "⁻³".
std::string superscript(int number);

/// Columns of equal width, two blanks apart; `left`: how many of the first are aligned left, the rest right. No trailing blanks.
std::string align_columns(std::vector<std::vector<std::string>> const& rows, int left);

/// "0.988", "< 0.001".
std::string probability_text(double probability);

}  // namespace sysid
