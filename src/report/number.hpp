// Numbers and units as text: exact for files, rounded to what is known for people.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "inference/convergence.hpp"

namespace sysid {

/// The shortest decimal that reads back as the same double; "NaN", "Inf", "-Inf", as R and Python read them.
std::string shortest(double value);

/// `digits` significant digits, plain or with an exponent, whichever is easier on the eye; "-" when not finite.
std::string significant(double value, int digits);

/// The numbers of one row, all with the digits the Monte Carlo error leaves and one exponent, "4.986e9"; a spread of quite another
/// size has its own.
struct SummaryText {
  std::string mean, median, sd, mad, q5, q95, rhat, ess_bulk, ess_tail;
};
SummaryText format_summary(Summary const& summary);

/// "1.00004 ± 0.00063", "(5.000 ± 0.033)·10⁹".
std::string mean_and_sd(Summary const& summary);

/// "4.986e9" for a page: "4.986·10⁹".
std::string pretty_number(std::string_view text);

/// "N s/m^3" as a reader likes it: "N·s/m³".
std::string pretty_unit(std::string_view unit);

/// Words with units in brackets: "input x = a [m/s^2]" as "input x = a [m/s²]".
std::string pretty_units(std::string_view words);

/// Words with a quantity in them, their powers raised and no more: "sigma 0.472 m/s^2".
std::string pretty_powers(std::string_view words);

/// Superscript digits: "⁻³".
std::string superscript(int number);

/// Number of characters of UTF-8.
int text_width(std::string_view text);

/// Columns of equal width, two blanks apart; `left`: how many of the first are aligned left, the rest right. No trailing blanks.
std::string align_columns(std::vector<std::vector<std::string>> const& rows, int left);

}  // namespace sysid
