// The words that give an offset or a trend a place in the model.
#include "diagnostics/residuals/residual_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/text/number.hpp"
#include "core/text/without_index.hpp"
#include "diagnostics/law/noise_words.hpp"
#include "diagnostics/law/round_number.hpp"
#include "result/experiment_words.hpp"

namespace sysid {
namespace {

bool is_number(Model const& model, NodeId node) { return model.graph[node].operation == Operation::constant; }

/// A parameter that already is added to what a node predicts, perhaps times a number: an offset that something holds.
Parameter const* added_parameter(Model const& model, NodeId node) {
  Node const& at = model.graph[node];
  auto const either = [&] {
    Parameter const* const left = added_parameter(model, at.a);
    return left != nullptr ? left : added_parameter(model, at.b);
  };
  switch (at.operation) {
    case Operation::leaf:
      return at.leaf_kind == LeafKind::parameter ? &model.parameters[static_cast<std::size_t>(at.index)] : nullptr;
    case Operation::add:
    case Operation::subtract:
      return either();
    case Operation::negate:
      return added_parameter(model, at.a);
    case Operation::multiply:
      return is_number(model, at.a)   ? added_parameter(model, at.b)
             : is_number(model, at.b) ? added_parameter(model, at.a)
                                      : nullptr;
    default:
      return nullptr;
  }
}

/// `pos` and `(2)` of `pos[1]` and `pos[2]`, which one statement observes.
struct WholeChannel {
  std::string name, size;
};
WholeChannel whole_channel(Model const& model, std::string const& element) {
  WholeChannel whole{without_index(element), ""};
  if (whole.name.size() == element.size()) return whole;
  for (Channel const& each : model.channels)  // elements ascend
    if (each.name.starts_with(whole.name + "["))
      whole.size = "(" + each.name.substr(whole.name.size() + 1, each.name.size() - whole.name.size() - 2) + ")";
  return whole;
}

/// An offset of a temperature is an interval.
std::string unit_of_offset(Channel const& channel) {
  if (!channel.unit || channel.unit_text().empty()) return {};
  return difference(*channel.unit).text;
}

std::string cure_of_held(Parameter const& held, bool several) {
  if (!held.prior) return fmt::format("`{0}` is added to this channel and is fixed: give `{0}` a prior", held.name);
  if (several && !held.per_experiment)
    return fmt::format(
        "`{0}` is added to this channel with the same value in all experiments: write `per experiment` after `{0}` where it is "
        "declared; if only this experiment has an offset, look for another cause in it",
        held.name);
  return fmt::format(
      "`{0}` is added to this channel, but its prior, or another quantity that depends on this parameter, prevents it from "
      "compensating the offset: widen the prior of `{0}`",
      held.name);
}

/// Predictions from samples before hold a part of an offset already.
bool reads_samples(Model const& model, NodeId node) {
  return model.graph.depends(
      node, [](Node const& leaf) { return leaf.leaf_kind == LeafKind::measured || leaf.leaf_kind == LeafKind::previous; });
}

/// What to add to what the noise of the channel lies about: lines of the model, and the statement with `sum` in it.
std::string added_to(Channel const& channel, std::string const& declarations, std::string const& sum, UserText const& text) {
  std::optional<std::string> const written = text.noise_statement_with ? text.noise_statement_with(channel, sum) : std::nullopt;
  if (written) return fmt::format("add {} to the model and write `{}`", declarations, *written);
  return fmt::format(
      "copy the model from its module into your file, and in the copy add {}, and add `{}` to the first argument of the "
      "distribution in `observe {}`",
      declarations, sum, without_index(channel.name));
}

/// A parameter of the channel whose prior allows three times `size`.
std::string declaration(std::string const& name, Channel const& channel, Model const& model, bool several, std::string const& unit,
                        double size) {
  return fmt::format("`parameter {}{}{}{} ~ normal(0, sd = {:g})`", name, whole_channel(model, channel.name).size,
                     several ? " per experiment" : "", unit.empty() ? "" : " [" + unit + "]", round_number_above(3 * size));
}

std::string cure(Model const& model, Channel const& channel, bool several, double size, UserText const& text) {
  NodeId const location = channel.noise.arguments.front();
  if (Parameter const* const held = added_parameter(model, location)) return cure_of_held(*held, several);
  std::string const name = free_name(without_index(channel.name) + "_offset", taken_names(model, text.mentions));
  std::string const added =
      added_to(channel, declaration(name, channel, model, several, unit_of_offset(channel), size), name, text);
  if (reads_samples(model, location))
    return fmt::format(
        "if the equation lacks a constant term, {}; if the sensor has an offset, the past samples already contain a part of it, "
        "and this parameter estimates the rest",
        added);
  return fmt::format(
      "if the sensor has an offset, estimate it: {}; otherwise look for an input with an offset, for a constant force that the "
      "model lacks, or for a restoring or damping force that is not the same in both directions",
      added);
}

std::string unit_of_slope(Channel const& channel, std::string const& time_unit) {
  std::string const unit = unit_of_offset(channel);
  return (unit.empty() || unit == "-" ? "1" : unit) + "/" + time_unit;
}

std::string cure(Model const& model, Channel const& channel, bool several, Trend const& trend, UserText const& text) {
  constexpr char const* otherwise =
      "look for what changes slowly during the record: a temperature, a force that grows, creep, a part that wears";
  NodeId const location = channel.noise.arguments.front();
  if (model.graph.depends(location, [](Node const& leaf) { return leaf.leaf_kind == LeafKind::time; }))
    return fmt::format("this channel has a term in time already: check the priors of its coefficients; otherwise {}", otherwise);
  auto const taken = taken_names(model, text.mentions);
  auto const named = [&](char const* suffix) { return free_name(without_index(channel.name) + suffix, taken); };
  std::string const drift = named("_drift");
  TimeName const time = text.time_name ? text.time_name(channel) : TimeName{};
  std::string declarations = time.declared ? "" : fmt::format("`time {} [s]`, ", time.text), sum = drift + "*" + time.text;
  if (added_parameter(model, location) == nullptr) {  // what drifts has some value at time 0
    std::string const offset = named("_offset");
    declarations += declaration(offset, channel, model, several, unit_of_offset(channel), trend.largest_value) + " and ";
    sum = offset + " + " + sum;
  }
  declarations += declaration(drift, channel, model, several, unit_of_slope(channel, trend.time_unit), trend.largest_slope);
  return fmt::format("if the sensor drifts, estimate its drift: {}; otherwise {}", added_to(channel, declarations, sum, text),
                     otherwise);
}

}  // namespace

bool offset_can_be_added(Model const& model, Channel const& channel) {
  Distribution const& noise = channel.noise;
  return !model.filtered() && !noise.row->discrete && noise.row->lower == nullptr && !noise.lower && !noise.upper;
}

Finding residual_offset(Model const& model, Channel const& channel, std::string const& experiment, bool several,
                        OffsetTest const& test, double size, double largest, UserText const& text) {
  return {FindingCode::residual_offset,
          Severity::warning,
          {channel.name, experiment},
          fmt::format("the residuals of {} have a mean of {}{}, {} times its standard error; the square of this mean is {} of "
                      "their mean square",
                      channel.name + on_experiment(experiment, several), significant(size, 3),
                      unit_after_number(unit_of_offset(channel)), significant(test.standard_errors, 2),
                      fmt::format("{:.3g} %", 100 * test.share)),
          cure(model, channel, several, largest, text)};
}

Finding residual_trend(Model const& model, Channel const& channel, std::string const& experiment, bool several,
                       TrendTest const& test, Trend const& trend, UserText const& text) {
  return {
      FindingCode::residual_trend,
      Severity::warning,
      {channel.name, experiment},
      fmt::format("the residuals of {} follow a line in time: a slope of {} {}, {} times its standard error, explains {} of their "
                  "mean square",
                  channel.name + on_experiment(experiment, several), significant(trend.slope, 3),
                  unit_of_slope(channel, trend.time_unit), significant(test.standard_errors, 2),
                  fmt::format("{:.3g} %", 100 * test.share)),
      cure(model, channel, several, trend, text)};
}

}  // namespace sysid
