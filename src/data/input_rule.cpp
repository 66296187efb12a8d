// The table of input rules.
#include "data/input_rule.hpp"

#include "core/setting/table.hpp"
#include "data/interpolation.hpp"

namespace sysid {
namespace {

using Numbers = std::span<double const>;

std::vector<double> zero_order(Numbers, Numbers samples) { return {samples.begin(), samples.end() - 1}; }
std::vector<double> linear(Numbers, Numbers samples) { return linear_coefficients(samples); }
std::vector<double> band_limited(Numbers, Numbers samples) { return band_limited_coefficients(samples); }

}  // namespace

std::span<InputRuleRow const> input_rules() {
  static constexpr InputRuleRow rows[] = {
      {.rule = InputRule::zero_order,
       .name = "zero_order",
       .usage = "hold zero_order",
       .summary = "the input is constant until its next sample",
       .degree = 0,
       .has_rate = false,
       .jumps = true,
       .coefficients = &zero_order},
      {.rule = InputRule::linear,
       .name = "linear",
       .usage = "hold linear",
       .summary = "the input is a straight line between samples",
       .degree = 1,
       .kinks = true,
       .coefficients = &linear},
      {.rule = InputRule::cubic,
       .name = "cubic",
       .usage = "hold cubic",
       .summary = "the input is smooth: a cubic spline through its samples",
       .degree = 3,
       .reach = 20,  // the effect of a sample falls by a factor of 3.7 per row: below 1e-11 there
       .coefficients = &cubic_coefficients},
      {.rule = InputRule::band_limited,
       .name = "band_limited",
       .usage = "hold band_limited",
       .summary = "the input was sampled after an anti-aliasing filter",
       .degree = band_limited_degree,
       .equal_steps = true,
       .reach = band_limited_reach,
       .band = 0.45,
       .coefficients = &band_limited},
  };
  return rows;
}

InputRuleRow const& row_of(InputRule rule) { return input_rules()[static_cast<std::size_t>(rule)]; }

std::optional<InputRule> find_input_rule(std::string_view name) {
  InputRuleRow const* row = row_named(input_rules(), name);
  return row == nullptr ? std::nullopt : std::optional(row->rule);
}

std::string_view rule_name(InputRule rule) { return row_of(rule).name; }

std::vector<std::string> input_rule_names() {
  std::vector<std::string> names;
  for (InputRuleRow const& row : input_rules()) names.emplace_back(row.name);
  return names;
}

}  // namespace sysid
