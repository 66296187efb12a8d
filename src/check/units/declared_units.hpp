// The units that a file declares, and units written with the file's own names.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "check/units/unit_words.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// A declared name with its unit. Names that move carry primes in equations.
struct DeclaredUnit {
  std::string name;
  Unit unit;
  bool moves = false;
};

/// What a declared name may read and be read by.
struct DeclaredRole {
  enum class Kind {
    varying,   // state, input, disturbance, time
    fixed,     // parameter
    constant,  // `constant`: reads constants alone
    local,     // `let`
    reported,  // `derive`: nothing reads it
  };
  Kind kind = Kind::fixed;
  std::vector<std::string> reads;  // names in the expression of a definition
  int places = 0;                  // statements that read it; 0: not counted
  bool in_widths_alone = false;    // all of them observations that read it in the width of their noise
};

class DeclaredUnits {
 public:
  void declare(DeclaredUnit declared);
  /// Of every declared name, with a unit or without one.
  void declare(std::string const& name, DeclaredRole role) { roles_.emplace(name, std::move(role)); }
  /// Where a declared name is read; see DeclaredRole.
  void note_places(std::string const& name, int places, bool in_widths_alone);

  /// A unit as the text has it, else in the names that it uses.
  std::string words(Unit const& unit) const;
  /// From now on expressions are those of this declared name; empty: of an equation. The place before, to go back to.
  std::string enter(std::string place) { return std::exchange(place_, std::move(place)); }

  /// What is wanted where a unit is not as it should be.
  struct Wanted {
    std::string unit;                                   // as the text would have it
    Dimension missing;                                  // the factor that the expression lacks
    bool pure = false;                                  // a pure number is wanted
    bool of_a_number = false;                           // the expression is one
    bool is_term = false;                               // of a sum or an equation, whose coefficient is its own
    std::vector<ast::Expression const*> agreeing = {};  // what is in this unit beside the expression
    double scale = 1;                                   // of the unit as its words say, in the SI; 0: names are not those declared
    bool is_reciprocal = false;                         // the reciprocal of the expression has the wanted dimension
    bool is_width = false;                              // of a distribution: nothing that moves belongs in it
    std::string of = {};                                // the name whose distribution has this width
    ast::Expression const* location = nullptr;          // of the same distribution
  };
  /// How an expression could be mended ("multiply it by a length, such as `y`"); odd: null where it is a declaration. Names are
  /// those that may stand in its place.
  std::string cure(ast::Expression const* odd, Wanted const& wanted) const;

  /// Whether `cycles` holds a frequency in Hz where `other`, which counts neither cycles nor radians, asks for an angular one: as a
  /// square (k = m omega^2), or as the factor of something else that moves beside a derivative in time (y'' + omega^2 y, y' =
  /// -omega y). A displacement per revolution times a speed in Hz is a flow: a frequency alone is no mistake. Null for a
  /// declaration.
  bool used_as_angular(ast::Expression const* cycles, Unit const& ours, ast::Expression const* other, Unit const& theirs) const;
  /// Of a declared name; null where it has no unit.
  Unit const* unit_of(std::string const& name) const;
  /// A name declared in a unit that counts cycles; empty without one.
  std::string frequency_in(ast::Expression const& tree) const;

 private:
  // A pound or a kilogram in place of its weight; empty where `g` may have been forgotten, or the mass is needed elsewhere.
  std::string by_weight(ast::Expression const& odd, Wanted const& wanted) const;
  // Of a bare number in a product, so that the numbers of the text keep their meaning: [kN/mm] of `0.5*x` beside what is in kN.
  std::string unit_of_number(ast::Expression const& odd, Wanted const& wanted) const;
  std::string by_inverse(ast::Expression const& odd, Dimension const& missing) const;
  // Of a width in the wrong unit: by its own declaration; empty where it is no name.
  std::string width_cure(ast::Expression const& odd, Wanted const& wanted) const;
  // By what is written wrongly though its names are declared well: a fraction turned over, lost parentheses, the gram for gravity.
  std::string writing_cure(ast::Expression const& odd, Wanted const& wanted) const;
  // The dimension of a name, with primes or without, or a power of one, and of a bare number; nothing for all else.
  std::optional<Dimension> simple_dimension(ast::Expression const& factor) const;
  // The one coefficient of a term, in the unit that it should have been declared in; nothing where something else is likelier.
  std::optional<DeclaredUnit> declared_otherwise(ast::Expression const& odd, Dimension const& missing, bool is_term) const;
  // Whether one power of something that moves in a term is what it lacks, or has too much.
  bool is_power_of_moving(ast::Expression const& odd, Dimension const& missing) const;
  // "`y`", "`y` or `l`": declared names of this dimension; but: as written, with their primes.
  enum class Which { all, fixed };  // fixed: of what does not move
  std::string named(Dimension const& dimension, std::vector<std::string> const& but, Which which) const;
  // What an expression contains and no cure may offer as a divisor, or as a factor.
  struct KeptOut {
    std::vector<std::string> divisors, factors;
  };
  // pure: a pure number is wanted.
  KeptOut names_kept_out(ast::Expression const& odd, bool pure) const;
  // Whether one is what is missing, or what is too much.
  bool another_name(Dimension const& missing, KeptOut const& but, Which which) const;
  // The term as it is declared, with another factor. what: is to be changed, "this" or "this term"; in_text: it is an expression,
  // no declaration; but: names that the factor must not be. Empty where no kind of quantity is missing.
  std::string factor_cure(std::string_view what, Wanted const& wanted, bool in_text, KeptOut const& but) const;
  // Whether the name may stand where expressions are checked: what is being defined must not read itself, nor what has one value
  // for a whole record something that varies in it.
  bool may_stand_here(std::string const& name) const;

  std::vector<DeclaredUnit> declared_;
  std::map<std::string, DeclaredRole> roles_;
  std::string place_;
  UnitNames names_in_use_;
};

}  // namespace sysid
