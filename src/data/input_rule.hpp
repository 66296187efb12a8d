// What an input does between its samples: one row per rule, which the checker, records, solvers and reports read. A new rule is an
// enumerator here, a row in input_rule.cpp and its polynomials in interpolation.cpp.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

enum class InputRule { zero_order, linear, cubic, band_limited };

struct InputRuleRow {
  InputRule rule;
  std::string_view name;
  std::string_view usage;    // as a data block states it
  std::string_view summary;  // one line of help
  int degree;                // of the polynomial on each interval
  bool has_rate = true;      // its time derivative may be used in equations
  bool jumps = false;        // its value jumps at a sample: a solver starts anew there
  bool kinks = false;        // its slope does
  bool equal_steps = false;  // the record needs equal time steps
  int reach = 0;             // rows before and after an interval, besides its two ends, that shape the curve in it
  double band = 0;           // content up to this part of the sampling rate is exact, and none is above half of it; 0: not assumed
  /// c_0 ... c_degree of each interval, [N - 1 x degree + 1], from samples [N] at time [N].
  std::vector<double> (*coefficients)(std::span<double const> time, std::span<double const> samples);
};

/// One row for each InputRule, in its order.
std::span<InputRuleRow const> input_rules();
InputRuleRow const& row_of(InputRule rule);
std::optional<InputRule> find_input_rule(std::string_view name);
/// "zero_order": the word that the user writes.
std::string_view rule_name(InputRule rule);
std::vector<std::string> input_rule_names();

}  // namespace sysid
