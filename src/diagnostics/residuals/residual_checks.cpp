// Scores and tests of what a fit leaves, and the words for what they find.
#include "diagnostics/residuals/residual_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/words.hpp"
#include "diagnostics/law/noise_law.hpp"
#include "diagnostics/law/noise_words.hpp"
#include "diagnostics/law/residual_law.hpp"
#include "diagnostics/residuals/channel_residuals.hpp"
#include "diagnostics/residuals/explained.hpp"
#include "diagnostics/residuals/outliers.hpp"
#include "diagnostics/residuals/residual_line.hpp"
#include "diagnostics/residuals/start_far_off.hpp"
#include "likelihood/output.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {
namespace {

/// nmse [%] from which a fit that leaves more than noise explains little, and less than half.
constexpr double little = 20, less_than_half = 50;

// What all channels of all experiments are judged by together.
struct Limits {
  int channels;
  double white, with_input;  // p values
};

Limits limits_of(std::vector<ChannelTests> const& all) {
  std::vector<double> white, with_input;
  for (ChannelTests const& each : all) {
    if (each.white) white.push_back(each.white->tail_p_value);
    for (CorrelationTest const& test : each.with_input) with_input.push_back(test.tail_p_value);
  }
  return {std::max(1, static_cast<int>(all.size())), limit_together(white), limit_together(with_input)};
}

// pattern: of the residuals, where what the fit leaves is more than noise; else null.
void check_share(ChannelResiduals const& of, ChannelTests const& tested, char const* pattern, Findings& findings) {
  char const* look = "check units, signs and columns, then the initial values and the priors, then the model";
  if (tested.first_cure() != nullptr)
    look = tested.first_cure();
  else if (tested.offset.fires)
    look =
        "an offset alone does not explain the misfit: check signs in the equation and of columns, and units, then the initial "
        "values and the priors, then the model";
  double const left = tested.unexplained;
  if (left > as_bad_as_the_mean(of.observed.size()))
    findings.push_back(worse_than_the_mean(left > useless_nmse || pattern != nullptr ? Severity::error : Severity::warning,
                                           of.names(), of.name(), left,
                                           fmt::format("the fit explains nothing of this channel: {}", look)));
  else if (pattern != nullptr && left > little)
    findings.push_back({FindingCode::explains_little, left > less_than_half ? Severity::error : Severity::warning, of.names(),
                        fmt::format("the fit explains {:.2g} % of the variance of {}, and its residuals {}",
                                    std::max(0.0, 100 - left), of.name(), pattern),
                        look});
}

// Samples far off, by their places along the experiment, and how far.
struct FarOff {
  std::vector<std::size_t> places;
  std::vector<double> sds;  // of all samples
  char const* others = "all others";
};

// Rows as the file counts them, with how far they lie off.
void check_outliers(ChannelResiduals const& of, FarOff const& far, UserText const& text, Findings& findings) {
  std::vector<std::size_t> const& places = far.places;
  if (places.empty()) return;
  std::string help = "check these rows: empty the cells that are not measurements";
  if (of.model().filtered())
    help += "; if all are measurements, the disturbance does not describe the motion there";
  else if (of.described().noise.row->gaussian)
    help += ", or " + use_heavy_tails(text.heavy_tailed ? text.heavy_tailed(of.described()) : std::nullopt);
  constexpr std::size_t most_named = 5;
  std::vector<std::string> named;
  for (std::size_t const place : places)
    if (named.size() < most_named)
      named.push_back(fmt::format("row {}, {:.0f} sds", of.data().first_row + static_cast<int>(place), std::fabs(far.sds[place])));
  if (places.size() > most_named) named.push_back("...");
  findings.push_back({FindingCode::samples_far_off, Severity::warning, of.names(),
                      fmt::format("{} of {} {} much farther from the fit than {} ({})", counted(places.size(), "sample"), of.name(),
                                  places.size() == 1 ? "lies" : "lie", far.others, fmt::join(named, "; ")),
                      help});
}

void check_line(ChannelResiduals const& of, ChannelTests const& tested, UserText const& text, Findings& findings) {
  bool const several = of.experiments.size() > 1;
  if (tested.offset.fires)
    findings.push_back(residual_offset(of.model(), of.described(), of.data().name, several, tested.offset, tested.offset_size,
                                       tested.largest_offset, text));
  if (tested.trend.fires)
    findings.push_back(residual_trend(of.model(), of.described(), of.data().name, several, tested.trend, tested.line, text));
}

constexpr double exact = 1e-8;  // nmse [%] that no sensor reaches

std::string size_help(ChannelResiduals const& of, ChannelTests const& tested, bool larger, bool coloured, UserText const& text) {
  // An offset or an outlier makes residuals larger: it does not explain that they are small.
  if (larger && tested.start) return "the first samples make the noise appear larger: give the initial values a distribution first";
  if (larger && !tested.far.empty()) return "a few outlying samples make the noise appear larger: check these first";
  if (char const* const first = tested.first_cure(); larger && first != nullptr) return first;
  if (!larger && !of.widths_at_end.empty()) {
    bool const one = of.widths_at_end.size() == 1;
    return fmt::format("the residuals are smaller than the lower {} of {} {}: lower {}{}", one ? "bound" : "bounds",
                       quoted(of.widths_at_end), one ? "allows" : "allow", one ? "it" : "them",
                       tested.unexplained < exact ? "; the record seems to have no noise at all, as a simulated one" : "");
  }
  if (of.noise_is_estimated())
    return "the model is incomplete, a prior excludes the values that fit, or other channels share this noise: check the residuals";
  Channel const& channel = of.described();
  if (channel.noise.row->name == "poisson") {
    if (!larger)
      return "the counts scatter less than counts of independent events: check that the column is neither smoothed nor a sum or a "
             "mean that was divided into several rows";
    if (coloured)
      return "the model is incomplete: the residuals are correlated in time, which overdispersed noise does not explain";
    std::string const shape = free_name(channel.name + "_shape", taken_names(of.model(), text.mentions));
    return use_overdispersed(shape, text.overdispersed ? text.overdispersed(channel, shape) : std::nullopt);
  }
  return larger ? "the noise is larger than stated, or the model is incomplete: estimate the noise, then check the residuals"
                : "the stated noise is too large: estimate it";
}

void check_size(ChannelResiduals const& of, ChannelTests const& tested, Limits const& limits, UserText const& text, FitLine& line,
                Findings& findings) {
  SizedResiduals const& sized = of.sized;
  ChiSquaredTest const size = sized.degrees.empty()
                                  ? chi_squared(sized.values, sized.excess_kurtosis, limits.channels, of.fitted())
                                  : chi_squared_of_counts(sized.values, sized.degrees, limits.channels, of.fitted());
  line.scores.push_back({{ScoreKind::chi_squared}, size.per_sample});
  if (!size.fires()) return;
  findings.push_back(
      {FindingCode::noise_size, Severity::error, of.names(),
       fmt::format("the residuals of {} do not have the stated size: chi-squared per sample is {:.3g}, expected {:.2f} to {:.2f}",
                   of.name(), size.per_sample, size.low, size.high),
       size_help(of, tested, size.per_sample >= 1, tested.white && tested.white->fires(limits.white), text)});
}

std::string memory_help(ChannelResiduals const& of, ChannelTests const& tested) {
  if (char const* const first = tested.first_cure()) return fmt::format("{}; then check the remaining residuals", first);
  std::string help =
      "look for a force or dynamics that the model lacks, or for coloured noise; until this is resolved, the errors of the "
      "estimates can be several times their sds";
  bool const normal = std::ranges::all_of(of.model().channels, [](Channel const& each) { return each.noise.row->gaussian; });
  if (of.model().integrated() && !of.model().filtered() && of.model().unknowns.empty() && of.model().processes.empty() && normal)
    help +=
        "; to estimate a force that was not measured, `sysid fit FILE --with-disturbance` (at the prompt `disturb`) adds "
        "`disturbance w ~ white(intensity = q)` to the model and compares both fits";
  return help;
}

// Of a model that has a past: correlation in time, and with the input's past.
void check_memory(ChannelResiduals const& of, ChannelTests const& tested, Limits const& limits, FitLine& line, Findings& findings) {
  CorrelationTest const& white = *tested.white;
  line.scores.push_back({{ScoreKind::whiteness}, white.p_value});
  if (white.fires(limits.white) && !tested.white_otherwise())
    findings.push_back({FindingCode::residuals_not_white, Severity::warning, of.names(),
                        fmt::format("residuals of {} are correlated in time ({} of {} lags outside the 99 % band)", of.name(),
                                    white.outside, white.correlation.size()),
                        memory_help(of, tested)});
  std::vector<Quantity> const& inputs = of.model().inputs;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    CorrelationTest const& crossed = tested.with_input[i];
    line.scores.push_back({{ScoreKind::input_correlation, inputs.size() > 1 ? inputs[i].name : ""}, crossed.p_value});
    if (crossed.fires(limits.with_input))
      findings.push_back(
          {FindingCode::input_in_residuals,
           Severity::warning,
           {inputs[i].name, of.described().name, of.data().name},
           fmt::format("past values of input {} are correlated with the residuals of {} ({} of {} lags outside the 99 % band)",
                       inputs[i].name, of.name(), crossed.outside, crossed.correlation.size()),
           "look for a part of the response to the input that the model misses"});
  }
}

// Those of the places that the growth of the noise does not explain.
FarOff far_off_in_growing_noise(ChannelResiduals const& of, std::vector<std::size_t> const& far) {
  std::vector<double> predicted(of.sized.values.size(), std::nan(""));
  for (std::size_t i = 0; i < of.places.size(); ++i) predicted[of.places[i]] = of.predicted[i];
  FarOff still{far, in_growing_units(of.sized.values, predicted, far), "noise that grows with the prediction explains"};
  std::erase_if(still.places, [&](std::size_t place) { return !(std::fabs(still.sds[place]) > far_off_sds); });
  return still;
}

// "row 101, 5.2 sds; ...", the largest first: those beyond six sds of what most others have. Where such samples make an estimated
// noise large they are not far off in its units.
std::string largest_residuals(ChannelResiduals const& of, std::vector<double> const& left, std::size_t first) {
  constexpr std::size_t most_named = 5;
  std::vector<double> sizes;
  for (double const each : left) sizes.push_back(std::fabs(each));
  if (sizes.empty()) return "";
  double const limit = far_off_sds * sd_of_mad * median(sizes);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (sizes[i] > limit) places.push_back(i);
  std::ranges::stable_sort(places, [&](std::size_t a, std::size_t b) { return sizes[a] > sizes[b]; });
  std::vector<std::string> named;
  for (std::size_t const place : places)
    if (named.size() < most_named)
      named.push_back(
          fmt::format("row {}, {:.1f} sds", of.data().first_row + static_cast<int>(of.places[first + place]), sizes[place]));
  if (places.size() > most_named) named.push_back("...");
  return fmt::format("{}", fmt::join(named, "; "));
}

// Of residuals that the other tests take for noise, but for single samples: whether it has the law and the one size that the model
// has. Noise that grows with the signal has such samples where the signal is large; heavy tails are another cure for them.
void check_law(ChannelResiduals const& of, ChannelTests const& tested, int together, UserText const& text, Findings& findings) {
  Channel const& channel = of.described();
  bool const heavy_tails = channel.noise.row->name == "student_t";
  if (!(channel.noise.row->gaussian || heavy_tails) || channel.noise.lower || channel.noise.upper) return;
  bool const far_alone =
      std::ranges::all_of(findings, [](Finding const& each) { return each.code == FindingCode::samples_far_off; });
  if (!far_alone) return;
  std::vector<double> left, predicted;
  for (std::size_t i = 0; i < of.places.size(); ++i) {
    if (tested.start && of.places[i] < samples_of_start) continue;
    left.push_back(of.residuals[of.places[i]]);
    predicted.push_back(of.predicted[i]);
  }
  ResidualLaw law = residual_law(left, predicted);
  if (heavy_tails || !findings.empty()) law.tail_p = 1;  // expected, or named sample by sample
  LawWords const words{of.names(),
                       of.name(),
                       of.model().filtered(),
                       taken_names(of.model(), text.mentions),
                       largest_residuals(of, left, of.places.size() - left.size()),
                       [&] { return text.heavy_tailed ? text.heavy_tailed(channel) : std::nullopt; },
                       [&](std::string const& relative) {
                         bool const interval = channel.unit && channel.unit->offset != 0;  // 0 degC is no zero
                         return text.proportional && !interval ? text.proportional(channel, relative) : std::nullopt;
                       }};
  auto finding = noise_law(law, rare / (2 * together), words);
  if (!finding) return;
  findings = {std::move(*finding)};
  if (!tested.far.empty()) check_outliers(of, far_off_in_growing_noise(of, tested.far), text, findings);
}

FitLine check_channel(ChannelResiduals const& of, ChannelTests const& tested, Limits const& limits, UserText const& text,
                      Findings& findings) {
  FitLine line{of.data().name, of.described().name, of.described().unit_text(), {}};
  line.scores = {{{ScoreKind::nmse}, of.nmse_of(of.observed, of.predicted)}, {{ScoreKind::rmse}, rmse(of.observed, of.predicted)}};
  Findings shape;
  check_line(of, tested, text, shape);
  check_size(of, tested, limits, text, line, shape);
  check_outliers(of, {tested.far, of.sized.values}, text, shape);
  if (tested.white) check_memory(of, tested, limits, line, shape);
  // Deviances of small counts are neither centred nor alike.
  bool const ordered = tested.white && !of.described().noise.row->discrete;
  bool const coloured = ordered && tested.white->fires(limits.white);
  bool const drifts = ordered && tested.unexplained > less_than_half && trend_p_value(of.residuals) < rare / limits.channels;
  if (tested.start) findings.push_back(initial_of_states(of, *tested.start));
  check_share(of, tested, coloured ? "are correlated in time" : drifts ? "have a trend in time" : nullptr, findings);
  check_law(of, tested, limits.channels, text, shape);
  findings.insert(findings.end(), shape.begin(), shape.end());
  return line;
}

// Of estimated noise: parameters that are as small as their prior allows, where that is not 0.
std::vector<std::string> widths_at_end(ModelTarget const& target, int e, Channel const& channel, ConstLanes values) {
  ParameterSpace const& space = *target.space();
  Graph const& graph = target.compiled()->model.graph;
  std::vector<std::string> names;
  for (int d = 0; d < space.dimension(); ++d) {
    FittedParameter const& fitted = space.rows()[static_cast<std::size_t>(space.sampled()[static_cast<std::size_t>(d)])];
    ParameterInfo const& info = space.infos()[static_cast<std::size_t>(d)];
    constexpr double nearly = 1e-3;
    if ((fitted.experiment >= 0 && fitted.experiment != e) || !(info.lower > 0) || values(d, 0) > info.lower * (1 + nearly))
      continue;
    bool const read = std::any_of(channel.noise.arguments.begin() + 1, channel.noise.arguments.end(), [&](NodeId argument) {
      return graph.depends(argument, [&](Node const& node) {
        return node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter && node.index == fitted.parameter;
      });
    });
    if (read) names.push_back(info.name);
  }
  return names;
}

// values: [D x 1] declared; residuals: all rows of the target.
void score_experiment(ModelTarget const& target, int e, ConstLanes values, LaneArray const& residuals,
                      std::vector<ChannelResiduals>& scored) {
  Model const& model = target.compiled()->model;
  Experiment const& experiment = target.experiments()[static_cast<std::size_t>(e)];
  Trajectory const trajectory(target.compiled(), experiment, target.options().solver, target.options().start_rows,
                              target.options().execution);
  LaneArray parameters(static_cast<int>(model.parameters.size()), 1);
  target.space()->select(target.space()->values_of_declared(values), e, parameters);
  Trajectory::Result const predicted = trajectory.run(parameters, {});
  for (int c = 0; c < static_cast<int>(model.channels.size()); ++c) {
    auto const channel = static_cast<std::size_t>(c);
    if (experiment.measured[channel].empty()) continue;
    ChannelResiduals of{model, target.experiments(), e, c, std::vector<double>(experiment.time.size(), std::nan("")), {}, {}, {},
                        {}};
    for (std::size_t r = 0; r < target.residual_places().size(); ++r) {
      auto const [of_experiment, at_channel, sample] = target.residual_places()[r];
      if (of_experiment != e || at_channel != c || sample < 0) continue;
      auto const i = static_cast<std::size_t>(sample);
      of.residuals[i] = residuals(static_cast<int>(r), 0);
      of.observed.push_back(model.channels[channel].from_si(experiment.measured[channel][i]));
      of.predicted.push_back(predicted.values[channel][0][i]);
      of.places.push_back(i);
    }
    if (of.observed.empty()) continue;
    DistributionRow const& noise = *model.channels[channel].noise.row;
    std::vector<std::vector<double>> const arguments = trajectory.noise_arguments(parameters, c);
    of.sized = noise.discrete ? pearson_residuals(noise, experiment.measured[channel], arguments, of.residuals)
                              : scaled_residuals(noise, arguments, of.residuals);
    of.widths_at_end = widths_at_end(target, e, model.channels[channel], values);
    scored.push_back(std::move(of));
  }
}

FitCheck check_scored(std::vector<ChannelResiduals> const& scored, UserText const& text = {}) {
  FitCheck check;
  std::vector<ChannelTests> tested;
  for (ChannelResiduals const& each : scored) tested.push_back(test_channel(each));
  for (std::size_t k = 0; k < scored.size(); ++k)
    for (std::size_t j = 0; j < scored.size(); ++j)
      if (scored[j].described().name == scored[k].described().name) {
        tested[k].largest_offset = std::max(tested[k].largest_offset, std::fabs(tested[j].offset_size));
        tested[k].line.largest_slope = std::max(tested[k].line.largest_slope, std::fabs(tested[j].line.slope));
        tested[k].line.largest_value = std::max(tested[k].line.largest_value, tested[j].line.largest_value);
      }
  Limits const limits = limits_of(tested);
  for (std::size_t k = 0; k < scored.size(); ++k)
    check.lines.push_back(check_channel(scored[k], tested[k], limits, text, check.findings));
  return check;
}

}  // namespace

FitCheck check_residuals(ModelTarget const& target, std::vector<double> const& declared, UserText const& text) {
  int const dimension = target.dimension();
  LaneArray values(dimension, 1), theta(dimension, 1), residuals(target.residual_count(), 1);
  for (int p = 0; p < dimension; ++p) values(p, 0) = declared[static_cast<std::size_t>(p)];
  target.unconstrain(values, theta);
  Ledger ledger;
  target.residuals(theta, residuals, ledger);
  std::vector<ChannelResiduals> scored;
  for (int e = 0; e < static_cast<int>(target.experiments().size()); ++e) score_experiment(target, e, values, residuals, scored);
  return check_scored(scored, text);
}

FitCheck check_residuals(Model const& model, std::vector<Experiment> const& experiments,
                         std::vector<StandardisedRows> const& rows) {
  std::vector<ChannelResiduals> scored;
  for (std::size_t e = 0; e < experiments.size(); ++e)
    for (std::size_t c = 0; c < model.channels.size(); ++c) {
      ChannelResiduals of{model, experiments, static_cast<int>(e), static_cast<int>(c), rows[e].residuals[c], {}, {}, {}, {}};
      for (std::size_t i = 0; i < of.residuals.size(); ++i) {
        if (std::isnan(of.residuals[i])) continue;
        of.observed.push_back(model.channels[c].from_si(experiments[e].measured[c][i]));
        of.predicted.push_back(rows[e].predicted[c][i]);
        of.places.push_back(i);
      }
      if (of.observed.empty()) continue;
      of.sized.values = of.residuals;
      scored.push_back(std::move(of));
    }
  return check_scored(scored);
}

}  // namespace sysid
