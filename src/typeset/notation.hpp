// How formulas are written down: MathML for pages, LaTeX for papers. Pieces go in written down, and so does what comes out.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sysid {

/// Signs between the pieces of a formula.
enum class Sign {
  plus,
  minus,
  negative,   // before a single operand
  times,      // a dot, before a number
  invisible,  // a thin space between factors
  equal,
  less,
  less_equal,
  greater,
  greater_equal,
  equal_to,  // a comparison
  not_equal,
  conjunction,
  disjunction,
  negation,
  range,  // from ... to
  comma,
  distributed,  // "is distributed as"
};

enum class Fence { parentheses, bars, brackets };

class Notation {
 public:
  virtual ~Notation() = default;
  /// A letter or word as it stands in a formula, Greek names as letters; a single letter is slanted, a word is not.
  virtual std::string letter(std::string_view text) const = 0;
  /// Upright: sin, LogUniform, kg.
  virtual std::string word(std::string_view text) const = 0;
  /// A calligraphic capital, N of the normal distribution.
  virtual std::string calligraphic(std::string_view text) const = 0;
  virtual std::string digits(std::string_view text) const = 0;
  virtual std::string quoted(std::string_view text) const = 0;
  virtual std::string sign(Sign sign) const = 0;
  virtual std::string row(std::vector<std::string> const& pieces) const = 0;
  virtual std::string fraction(std::string const& above, std::string const& below) const = 0;
  virtual std::string raised(std::string const& base, std::string const& exponent) const = 0;
  virtual std::string lowered(std::string const& base, std::string const& index) const = 0;
  virtual std::string root(std::string const& inside) const = 0;
  virtual std::string fenced(Fence fence, std::string const& inside) const = 0;
  /// Derivatives by time: one to three dots above.
  virtual std::string dotted(std::string const& base, int dots) const = 0;
  /// Values with their conditions behind a brace; the last condition may be empty: otherwise.
  virtual std::string cases(std::vector<std::pair<std::string, std::string>> const& branches) const = 0;
  /// A blank as between a number and its unit.
  virtual std::string thin_space() const = 0;
};

Notation const& mathml_notation();
Notation const& latex_notation();

}  // namespace sysid
