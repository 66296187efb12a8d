// Which quantities must agree in unit, and which of them does not. Wording: unit_errors.cpp.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "check/units/declared_units.hpp"
#include "check/units/quantity.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// One of several things that must have one unit: an expression, or a declaration (no tree) that says which unit that is.
struct UnitOperand {
  Typed value;
  ast::Expression const* tree = nullptr;
  int side = 0;  // of an equation: 0 left, 1 right
};
inline bool is_known(UnitOperand const& operand) { return operand.value.kind == Typed::Kind::known; }

/// Why things must have one unit.
struct Occasion {
  enum class Kind { terms, comparison, branches, arguments, declared, distribution };
  Kind kind = Kind::terms;
  std::string what = {};  // arguments: the function; declared: the name; distribution: the argument
  std::string of = {};    // distribution: the name of the variate
  std::string note = {};  // stands under the declaration in place of its unit
  bool is_width = false;  // what is declared as a temperature stands for a difference of two
  std::vector<std::pair<Dimension, std::string>> cures = {};  // of what has another dimension: what it is likelier to be
  ast::Expression const* location = nullptr;                  // distribution: the one that a width belongs to
};

/// Compares units where they must agree, adds a diagnostic where they do not, and remembers what could not be compared. Nothing is
/// said of what is unknown: after an error an expression is made unknown by the caller, so that one mistake gives one message.
class UnitCheck {
 public:
  /// graph: of the values that are compared.
  UnitCheck(Graph const& graph, Diagnostics& diagnostics) : graph_(&graph), diagnostics_(&diagnostics) {}
  UnitCheck(UnitCheck const& other, Diagnostics& diagnostics) : UnitCheck(other) { diagnostics_ = &diagnostics; }

  /// Known to the help lines ("multiply it by a length, such as `y`").
  void declare(DeclaredUnit declared) { declared_.declare(std::move(declared)); }
  void declare(std::string const& name, DeclaredRole role) { declared_.declare(name, std::move(role)); }

  void note_places(std::string const& name, int places, bool in_widths_alone) {
    declared_.note_places(name, places, in_widths_alone);
  }

  /// Whose expression is checked from now on; see DeclaredUnits::enter.
  std::string enter(std::string place) { return declared_.enter(std::move(place)); }

  /// False, with a diagnostic, when the known units differ. The odd ones out are those that the majority does not share.
  bool agree(Occasion const& occasion, std::span<UnitOperand const> operands);
  /// An argument that must be a pure number; `angle`: of sin, cos or tan, where cycles are warned of.
  bool pure(std::string const& function, UnitOperand const& argument, bool angle);
  /// A power: the exponent is pure, and constant where the base has a dimension.
  bool power(UnitOperand const& base, UnitOperand const& exponent, std::optional<double> constant);
  /// False, with a diagnostic, when two temperatures that meet count from different zeros; addends: see `compare_zeros`.
  bool one_zero(Graph const& graph, UnitOperand const& a, UnitOperand const& b, bool addends);
  bool one_zero(Graph const& graph, std::span<UnitOperand const> operands);
  /// What stands for true or false; before_value: followed by its value, with which it may have changed places.
  bool condition(UnitOperand const& operand, bool before_value = false);

  /// While the body of a function is looked at for a call: mistakes in it are reported at the call.
  void enter_call(Span call, std::string const& function) { calls_.push_back({call, function}); }
  void leave_call() { calls_.pop_back(); }
  /// Forgets the calls around a definition that is looked at on its first use; give them back with `resume`.
  struct Call {
    Span span;
    std::string function;
  };
  std::vector<Call> suspend() { return std::exchange(calls_, {}); }
  void resume(std::vector<Call> calls) { calls_ = std::move(calls); }

  /// Expressions whose unit was needed and not known; why: empty where they read names without a unit.
  struct NotCompared {
    ast::Expression const* tree;
    std::string why;
  };
  std::vector<NotCompared> const& not_compared() const { return not_compared_; }

  /// A unit as the text has it, else in the names that it uses.
  std::string words(Unit const& unit) const { return declared_.words(unit); }
  /// Of every conflict the factor that what was shown lacks.
  std::vector<Dimension> const& missing() const { return missing_; }

 private:
  void hint_cycles(std::span<UnitOperand const> operands);
  // True with a warning: a factor in the text does what the unit does by itself.
  bool hint_converted_twice(std::span<UnitOperand const> operands);
  // in_function: an argument of one that takes an angle.
  bool converted_angle(UnitOperand const& operand, bool in_function);
  bool converted_factor(UnitOperand const& operand, std::span<UnitOperand const> operands);
  void hint_constants(std::span<UnitOperand const> operands);
  void hint_degrees(std::string const& function, UnitOperand const& argument);
  // `initial th = 30` of th in [rad].
  void hint_degrees_given(Occasion const& occasion, std::span<UnitOperand const> operands);
  void hint_bare_numbers(std::span<UnitOperand const> operands);
  Label unit_label(UnitOperand const& operand) const;
  void remember(UnitOperand const& operand, std::string why = {});
  void report(Diagnostic diagnostic);

  Graph const* graph_;
  Diagnostics* diagnostics_;
  DeclaredUnits declared_;
  std::vector<Call> calls_;
  std::vector<std::pair<Span, std::string>> said_in_functions_;
  std::vector<NotCompared> not_compared_;
  std::vector<Dimension> missing_;
};

}  // namespace sysid
