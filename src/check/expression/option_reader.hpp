// The options of a task, as `key = value` or `call(...)`: numbers of a kind, range and unit, words among choices, each given once.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "check/checked/checked.hpp"
#include "check/expression/scope.hpp"
#include "check/message/subject.hpp"
#include "core/setting/settings.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// The word an option goes by: its key, else the name of the function or quantity it is.
std::string key_of(ast::Option const& option);
/// Null for anything but a call.
ast::Call const* as_call(ast::Expression const& expression);
/// A name without primes, or a text.
std::optional<std::string> as_word(ast::Expression const& expression);
/// Where the function's or quantity's name stands.
Span head_span(ast::Expression const& expression);
/// Of a unit's name; dimensionless for none.
Unit unit_of(std::string_view atom);

/// Nothing is returned, or `place` left alone, when a diagnostic was added.
class OptionReader {
 public:
  /// verbs_with: which verbs have an option; null where no task is read.
  using VerbsWith = std::vector<std::string> (*)(std::string_view option);
  OptionReader(std::string verb, Diagnostics& diagnostics, VerbsWith verbs_with = nullptr)
      : verb_(std::move(verb)), verbs_with_(verbs_with), diagnostics_(diagnostics), scope_(graph_, diagnostics, {}) {}

  /// What a number of another kind would be right for, and how it is written there.
  struct OtherPlace {
    Unit unit;
    std::string help;
  };
  /// Of a number of rows: a time.
  static OtherPlace time_for_rows() {
    return {unit_of("s"), "write a pure number: a number of rows is a time multiplied by the rate, as 500 for 10 s at 50 Hz"};
  }
  /// A number known before the run, SI. unit: absent where nothing is declared, and anything goes.
  std::optional<double> number(ast::Expression const& tree, std::string const& name, std::optional<Unit> const& unit, double least,
                               double most, bool whole = false, std::optional<OtherPlace> const& elsewhere = std::nullopt);
  /// The same of a share, a weight or a setting, which is no angle, though the SI has degrees as pure numbers as well. What a file
  /// declares in [-] may be one. A setting may have a unit.
  std::optional<double> pure_number(ast::Expression const& tree, std::string const& name, Unit const& unit, double least,
                                    double most);
  /// A number >= 0 that is a difference of two, such as an sd: of temperatures it has no zero point, so that 0.5 [degC] is 0.5 K.
  std::optional<double> width(ast::Expression const& tree, std::string const& name, std::optional<Unit> unit, double least = 0);
  void whole(ast::Option const& option, std::string const& name, double least, double most, int& place);
  /// yes or no.
  void flag(ast::Option const& option, std::string const& name, bool& place);
  void seed(ast::Option const& option, std::optional<std::uint64_t>& place);
  /// record, rest or estimated(rows = 50).
  void start(ast::Option const& option, StartRule& place);
  /// `substeps = n`, short for rk4, or `solver = cvode(relative = 1e-8)`; one of them, once. Whether its accuracy was stated.
  bool solver(ast::Option const& option, SolverSettings& place);
  /// Where the solver was stated.
  std::optional<Span> const& solver_span() const { return solver_; }
  /// A table of settings against `name(key = value, ...)`.
  void settings(ast::Call const& call, std::span<SettingRow const> rows, Settings& place);

  /// False, with a diagnostic, when the option was given before.
  bool fresh(ast::Option const& option, std::string const& key);
  /// The same of the back end, whichever it is.
  bool fresh_backend(ast::Option const& option);
  void unknown(ast::Option const& option, std::vector<std::string> const& known);

 private:
  std::optional<double> number_of(Typed const& value, Span place, std::string const& name, std::optional<Unit> const& unit,
                                  double least, double most, bool whole, std::optional<OtherPlace> const& elsewhere);
  /// With a diagnostic: an angle where a pure number is no angle.
  bool refused_angle(Typed const& value, Span place, std::string const& name, std::optional<Unit> const& unit);
  std::optional<bool> yes_or_no(ast::Expression const& tree, std::string const& name);
  void setting(ast::Argument const& argument, SettingRow const& row, Settings& place);
  // owner: the verb, or what the verb's task has settings of.
  errors::OptionOwner owner(std::string name, std::string_view option) const;

  std::string verb_;
  VerbsWith verbs_with_;
  Diagnostics& diagnostics_;
  Graph graph_;
  Scope scope_;
  std::map<std::string, Span> seen_;
  std::optional<Span> solver_, backend_;  // where they were stated
};

}  // namespace sysid
