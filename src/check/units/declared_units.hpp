// The units that a file declares, and units written with the file's own names.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "check/message/unit_words.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// A declared name with its unit. Names that move carry primes in equations.
struct DeclaredUnit {
  std::string name;
  Unit unit;
  bool moves = false;
};

class DeclaredUnits {
 public:
  void declare(DeclaredUnit declared);

  /// A unit as the text has it, else in the names that it uses.
  std::string words(Unit const& unit) const;
  /// How an expression that lacks the factor `missing` could be mended ("multiply it by a length, such as `y`"); odd: null where it
  /// is a declaration; wanted: the unit it should have; pure: a pure number is wanted; is_term: of a sum
  /// or an equation, whose coefficient is its own.
  std::string cure(ast::Expression const* odd, std::string const& wanted, Dimension const& missing, bool pure,
                   bool is_term = false) const;

  /// Whether `cycles` holds a frequency in Hz where `other`, which counts neither cycles nor radians, asks for an angular one: as a
  /// square (k = m omega^2), or as the factor of something else that moves beside a derivative in time (y'' + omega^2 y, y' =
  /// -omega y). A displacement per revolution times a speed in Hz is a flow: a frequency alone is no mistake. Null for a
  /// declaration.
  bool used_as_angular(ast::Expression const* cycles, Unit const& ours, ast::Expression const* other, Unit const& theirs) const;
  /// A name declared in a unit that counts cycles; empty without one.
  std::string frequency_in(ast::Expression const& tree) const;

 private:
  std::string factor_cure(std::string const& wanted, Dimension const& missing, std::vector<std::string> const& but) const;
  // The one coefficient of a term, in the unit that it should have been declared in; nothing where something else is likelier.
  std::optional<DeclaredUnit> declared_otherwise(ast::Expression const& odd, Dimension const& missing, bool is_term) const;
  // Whether one power of something that moves in a term is what it lacks, or has too much.
  bool is_power_of_moving(ast::Expression const& odd, Dimension const& missing) const;
  // "`y`", "`y` or `l`": declared names of this dimension.
  std::string named(Dimension const& dimension, std::vector<std::string> const& but) const;

  std::vector<DeclaredUnit> declared_;
  UnitNames names_in_use_;
};

}  // namespace sysid
