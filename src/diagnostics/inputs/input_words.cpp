// The cure of a delay is a column that is moved in the file, or another lag in an equation in discrete time.
#include "diagnostics/inputs/input_words.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <set>
#include <vector>

#include "core/text/words.hpp"
#include "diagnostics/inputs/input_leaves.hpp"

namespace sysid {
namespace {

std::string const& name_of(InputOf const& input) { return input.model.inputs[input.index].name; }

std::string of_samples(int count) { return counted(static_cast<std::size_t>(count), "sample"); }
std::string of_rows(int count) { return counted(static_cast<std::size_t>(count), "row"); }

/// Rows at one end then have no input.
std::string move_column(std::string const& what, bool down, int count) {
  return fmt::format("move {} {} by {} in the file and leave out the {} {}", what, down ? "down" : "up", of_rows(count),
                     down ? "first" : "last", count == 1 ? "row" : of_rows(count));
}

/// Samples back that the equations read of an input, each once.
std::set<int> lags_of(InputOf const& input) {
  std::set<int> lags;
  for (Node const& leaf : leaves_of_input(input.model, static_cast<int>(input.index)))
    if (leaf.leaf_kind == LeafKind::input) lags.insert(leaf.lag);
  return lags;
}

/// What to write where the input acts so many samples later than the equations have it.
std::string lag_advice(InputOf const& input, int later) {
  std::string const& name = name_of(input);
  std::set<int> const lags = lags_of(input);
  if (lags.empty() || *lags.begin() + later < 0)
    return fmt::format("the column of {} is delayed by {} relative to the response: {}, or correct the delay of the recording",
                       name, of_samples(std::abs(later)), move_column("it", false, std::abs(later)));
  auto const written = [&](int lag) { return lag == 0 ? "`" + name + "`" : fmt::format("`lag({}, {})`", name, lag); };
  std::string const read = lags.size() == 1
                               ? fmt::format("write {} in place of {}", written(*lags.begin() + later), written(*lags.begin()))
                               : fmt::format("{} {} {} each lag of `{}`", later > 0 ? "add" : "subtract", std::abs(later),
                                             later > 0 ? "to" : "from", name);
  return fmt::format("{} if the system has this delay; otherwise correct the delay of the recording of {}", read, name);
}

std::string_view at_least(int samples) { return samples >= most_samples ? "at least " : ""; }

std::string after_the_largest(int samples) {
  return samples >= most_samples ? "; larger shifts were not tried: correct this one and run again" : "";
}

std::string better_shifted(InputOf const& input, bool later, std::string const& by, double gain, int scored) {
  return fmt::format("the fit is much better with input {}{} shifted {} by {} (log density higher by {:.0f} for {} samples)",
                     name_of(input), input.on, later ? "later" : "earlier", by, gain, scored);
}

}  // namespace

Finding other_rule(InputOf const& input, InputRule better, double gain, int scored) {
  std::string_view const stated = rule_name(input.experiment.inputs[input.index].rule()), other = rule_name(better);
  return {FindingCode::input_rule,
          Severity::warning,
          {name_of(input), input.experiment.name, std::string(other)},
          fmt::format("the fit is clearly better with `hold {}` than with `hold {}` for input {}{} (log density higher by {:.0f} "
                      "for {} samples)",
                      other, stated, name_of(input), input.on, gain, scored),
          fmt::format("write `hold {}` if {}; otherwise check whether a channel was recorded with a delay", other,
                      row_of(better).summary)};
}

Finding smooth_input(InputOf const& input, std::string const& parameter, double sds) {
  return {FindingCode::input_rule,
          Severity::warning,
          {name_of(input), input.experiment.name, std::string(rule_name(InputRule::cubic)), parameter},
          fmt::format("input {}{} is smooth between its samples: with `hold cubic` in place of `hold linear`, {} changes by {:.1f} "
                      "sds, and the fit is as good",
                      name_of(input), input.on, parameter, sds),
          fmt::format("write `hold cubic` ({}) unless you know that the input is linear between samples",
                      row_of(InputRule::cubic).summary)};
}

Finding other_timing(InputOf const& input, double shift, double gain, int scored) {
  std::vector<std::string> const names = {name_of(input), input.experiment.name};
  bool const later = shift > 0;
  if (std::fabs(shift) < 1)
    return {FindingCode::input_timing, Severity::warning, names, better_shifted(input, later, "half a sample", gain, scored),
            "check the delay of the recording: no other rule between input samples explains the record as well"};
  int const count = static_cast<int>(std::fabs(shift));
  std::vector<double> const& time = input.experiment.time;
  std::string const by = unequal_step(time) == 0
                             ? fmt::format("{}{} ({:.4g} s)", at_least(count), of_samples(count), count * mean_step(time))
                             : fmt::format("{}{}", at_least(count), of_samples(count));
  std::string const help =
      later
          ? fmt::format(
                "the response begins {} after the input: if the recording causes this, {}; otherwise the model lacks a dead time, "
                "a slow actuator or a slow sensor of about this size (`tau*z' = y - z`, with `observe` of `z`)",
                by, move_column("the column of " + name_of(input), true, count))
          : fmt::format("the column of {} is delayed by {} relative to the response: {}, or correct the delay of the recording",
                        name_of(input), by, move_column("it", false, count));
  return {FindingCode::input_timing, Severity::warning, names, better_shifted(input, later, by, gain, scored),
          help + after_the_largest(count)};
}

Finding other_lag(InputOf const& input, int later, double gain, int scored) {
  return {
      FindingCode::input_timing,
      Severity::warning,
      {name_of(input), input.experiment.name},
      better_shifted(input, later > 0, fmt::format("{}{}", at_least(std::abs(later)), of_samples(std::abs(later))), gain, scored),
      lag_advice(input, later) + after_the_largest(std::abs(later))};
}

}  // namespace sysid
