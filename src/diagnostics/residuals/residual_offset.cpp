// The test of a mean, and the words that give it a place in the model.
#include "diagnostics/residuals/residual_offset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numeric/elementary.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "core/text/without_index.hpp"
#include "diagnostics/law/noise_words.hpp"
#include "diagnostics/law/round_number.hpp"
#include "diagnostics/residuals/residual_tests.hpp"
#include "result/experiment_words.hpp"

namespace sysid {
namespace {

constexpr double no_chance = 6;  // standard errors

std::vector<double> scored_values(std::span<double const> series) {
  std::vector<double> values;
  std::copy_if(series.begin(), series.end(), std::back_inserter(values), [](double each) { return !std::isnan(each); });
  return values;
}

/// Sum of squares of the autocovariances, each times the number of samples.
double covariances(CorrelationTest const& test, std::span<double const> series) {
  double power = 0, sum = 0;
  for (double const each : series)
    if (!std::isnan(each)) power += each * each;
  for (double const each : test.correlation) sum += each * each;
  return power * power * sum;
}

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
  return fmt::format(" [{}{}]", channel.unit->offset != 0 ? "delta_" : "", channel.unit_text());
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

std::string cure(Model const& model, Channel const& channel, bool several, double size, UserText const& text) {
  NodeId const location = channel.noise.arguments.front();
  if (Parameter const* const held = added_parameter(model, location)) return cure_of_held(*held, several);
  WholeChannel const whole = whole_channel(model, channel.name);
  std::string const name = free_name(whole.name + "_offset", taken_names(model, text.mentions));
  std::string const declaration =
      fmt::format("parameter {}{}{}{} ~ normal(0, sd = {:g})", name, whole.size, several ? " per experiment" : "",
                  unit_of_offset(channel), round_number_above(3 * size));
  std::optional<std::string> const written = text.noise_statement_with ? text.noise_statement_with(channel, name) : std::nullopt;
  std::string const added = written ? fmt::format("add `{}` to the model and write `{}`", declaration, *written)
                                    : fmt::format(
                                          "copy the model from its module into your file, and in the copy add `{}`, and add `{}` "
                                          "to the first argument of the distribution in `observe {}`",
                                          declaration, name, whole.name);
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

}  // namespace

// In means of neighbours, so that the number of products stays small.
double squared_standard_error(std::span<double const> values) {
  constexpr std::size_t most = 2000;
  std::size_t const width = (values.size() + most - 1) / most, count = values.size() / width;
  std::vector<double> means;
  for (std::size_t i = 0; i < count; ++i) means.push_back(mean(values.subspan(i * width, width)));
  double const center = mean(means);
  auto const covariance = [&](std::size_t lag) {
    double sum = 0;
    for (std::size_t i = 0; i + lag < count; ++i) sum += (means[i] - center) * (means[i + lag] - center);
    return sum / static_cast<double>(count);
  };
  double sum = -covariance(0);
  for (std::size_t lag = 0; lag + 1 < count; lag += 2) {
    double const pair = covariance(lag) + covariance(lag + 1);
    if (!(pair > 0)) break;
    sum += 2 * pair;
  }
  return std::max(sum, covariance(0) / static_cast<double>(count)) / static_cast<double>(count);
}

OffsetTest offset_test(std::span<double const> residuals, bool ordered) {
  OffsetTest test;
  std::vector<double> const values = scored_values(residuals);
  constexpr std::size_t fewest = 20;
  if (values.size() < fewest) return test;
  double const center = mean(values), variance = population_variance(values);
  double const squared_error = ordered ? squared_standard_error(values) : variance / static_cast<double>(values.size());
  test.share = center * center / (center * center + variance);
  test.standard_errors = std::fabs(center) / std::sqrt(squared_error);
  if (!(test.standard_errors > no_chance)) return test;
  if (!ordered) {
    test.fires = test.share > 0.5;
    return test;
  }
  std::vector<double> centred(residuals.begin(), residuals.end());
  for (double& each : centred) each -= center;
  CorrelationTest const before = whiteness(residuals), after = whiteness(centred);
  test.white_without = !after.fires();
  constexpr double little = 0.05;
  test.fires = before.fires() && (test.white_without || covariances(after, centred) < little * covariances(before, residuals));
  return test;
}

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
                      channel.unit_text().empty() ? "" : " " + channel.unit_text(), significant(test.standard_errors, 2),
                      fmt::format("{:.3g} %", 100 * test.share)),
          cure(model, channel, several, largest, text)};
}

}  // namespace sysid
