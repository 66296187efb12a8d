// Numbers as programs and countries write them.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

enum class CellKind { number, missing, text, not_finite, out_of_range };

/// How numbers are written, and what stands for none.
struct NumberNotation {
  char decimal = '.';
  char thousands = 0;  // ' ' is also a narrow or unbreakable blank
  std::vector<std::string> missing{};

  bool plain() const { return decimal == '.' && thousands == 0; }
};

/// The text of a number with a point and without groups; nothing where groups are not of three digits, or where the sign of another
/// notation stands. What is no number stays none.
std::optional<std::string> in_plain_notation(std::string_view cell, NumberNotation const& notation);

/// The number of a cell, quoted or not, with blanks and a + around; missing where the cell is empty, NA or one of the words. Groups
/// of digits have three digits each, and stand before the decimal sign. The minus sign U+2212 is one, and `1.5D-03` has an
/// exponent.
CellKind parse_cell(std::string_view cell, NumberNotation const& notation, double& value);

/// As the file would write it, without groups.
std::string text_of_number(double value, NumberNotation const& notation);

/// What the signs in a cell say of the notation. A single sign before exactly three digits (`1.234`) may be either.
struct NotationEvidence {
  bool number = false;        // in some notation
  char decimal = 0;           // surely the decimal sign
  char thousands = 0;         // surely between groups
  char either = 0;            // one of the two
  bool plain_digits = false;  // no sign at all
};
NotationEvidence notation_of(std::string_view cell);

}  // namespace sysid
