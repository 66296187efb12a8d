// Residual tests per experiment and channel, and the timing of the inputs.
#include "app/fit_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/elementary.hpp"
#include "distribution/deviance.hpp"
#include "inference/refit.hpp"
#include "inference/residual_tests.hpp"
#include "likelihood/output.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {
namespace {

constexpr double gain_per_sample = 0.2;  // nats
constexpr double gain_at_least = 20;

// " on bench.train", where there is more than one experiment to tell apart.
std::string on(ModelTarget const& target, int experiment) {
  if (target.experiments().size() == 1) return {};
  return " on " + target.experiments()[static_cast<std::size_t>(experiment)].name;
}

// Residuals of unit size, and how much heavier than normal their tails are: what chi-squared is taken of.
struct SizedResiduals {
  std::vector<double> values;
  double excess_kurtosis = 0;  // mean over the samples
};

// Pearson's, of counts: the deviance residuals of small counts are not of unit size.
// arguments: of the channel's noise, at every sample; deviance: one residual per sample, NaN where not scored.
SizedResiduals pearson(DistributionRow const& noise, std::vector<double> const& measured,
                       std::vector<std::vector<double>> const& arguments, std::vector<double> const& deviance) {
  SizedResiduals result;
  double count = 0;
  for (std::size_t i = 0; i < deviance.size(); ++i) {
    result.values.push_back(std::nan(""));
    if (std::isnan(deviance[i]) || !(noise.variance(arguments[i]) > 0)) continue;
    result.values.back() = (measured[i] - arguments[i][0]) / std::sqrt(noise.variance(arguments[i]));
    result.excess_kurtosis += noise.excess_kurtosis(arguments[i]);
    count += 1;
  }
  if (count > 0) result.excess_kurtosis /= count;
  return result;
}

// Deviance residuals over their size under the noise, which for heavy tails is above 1. It depends on the shape of the noise alone,
// not on place and width, and a shape that changes along the record is met at a few of its samples.
SizedResiduals scaled(DistributionRow const& noise, std::vector<std::vector<double>> const& arguments,
                      std::vector<double> deviance) {
  constexpr std::size_t looked_at = 4;
  DevianceMoments moments{0, 0};
  double count = 0;
  std::size_t const step = std::max<std::size_t>(1, deviance.size() / looked_at);
  for (std::size_t i = 0; i < deviance.size(); ++i) {
    if (std::isnan(deviance[i]) || (count > 0 && i % step != 0) || !noise.refuse(arguments[i]).empty()) continue;
    DevianceMoments const here = deviance_moments(noise, arguments[i]);
    moments.mean += here.mean;
    moments.variance += here.variance;
    count += 1;
  }
  if (count == 0) return {std::move(deviance), 0};
  moments = {moments.mean / count, moments.variance / count};
  constexpr double as_normal = 1e-4;
  if (std::fabs(moments.mean - 1) < as_normal) return {std::move(deviance), 0};
  for (double& residual : deviance) residual /= std::sqrt(moments.mean);
  return {std::move(deviance), moments.excess_kurtosis()};
}

/// nmse [%] from which a fit is no model of its record: the error is larger than what there was to explain.
constexpr double useless = 200;

// Whether the fit predicts a channel worse than the mean of what was measured would, by more than chance: of n samples of noise
// about the right prediction the sums of squares about the two differ by less than sigma^2 chi-squared(2), of 99.9 % quantile 13.8.
// Multiplicative noise is compared by logarithms, where its size is one. Nothing is said of a channel that did not change.
bool explains_nothing(DistributionRow const& noise, std::vector<double> observed, std::vector<double> predicted) {
  constexpr double excess = 13.8;
  if (noise.lower != nullptr && !noise.discrete) {
    for (std::vector<double>* const series : {&observed, &predicted})
      for (double& value : *series) value = value > 0 ? elementary::log(value) : std::nan("");
    for (std::size_t i = 0; i < observed.size(); ++i)
      if (std::isnan(predicted[i])) observed[i] = std::nan("");
  }
  auto const samples =
      static_cast<double>(std::count_if(observed.begin(), observed.end(), [](double value) { return !std::isnan(value); }));
  return samples > 0 && nmse(observed, predicted) > 100 * (1 + excess / samples);
}

// residuals: standardised, one per sample of the experiment, NaN where not scored.
void test_channel(ModelTarget const& target, int experiment, int channel, std::vector<double> const& residuals,
                  SizedResiduals const& sized, FitLine& line, Findings& findings) {
  Model const& model = target.compiled()->model;
  std::string const name = model.channels[static_cast<std::size_t>(channel)].name + on(target, experiment);
  ChiSquaredTest const size = chi_squared(sized.values, sized.excess_kurtosis);
  line.scores.push_back({"chi_squared_per_sample", size.per_sample});
  if (size.fires())
    findings.push_back(
        {Severity::error, "noise_size",
         fmt::format("residuals of {} are not of the stated size: chi-squared per sample is {:.3g}, expected {:.2f} to {:.2f}",
                     name, size.per_sample, size.low, size.high),
         size.per_sample > 1
             ? "the noise is larger than stated, or the model misses something: estimate the noise, then look at the residuals"
             : "the stated noise is too large: estimate it"});
  if (model.dynamics == Dynamics::none) return;  // rows of any order have no past
  CorrelationTest const white = whiteness(residuals);
  line.scores.push_back({"whiteness_p", white.p_value});
  if (white.fires())
    findings.push_back({Severity::warning, "residuals_not_white",
                        fmt::format("residuals of {} are correlated in time ({} of {} lags outside the 99 % band)", name,
                                    white.outside, white.correlation.size()),
                        "the model misses dynamics or the noise is coloured: posterior widths are too small"});
  Experiment const& data = target.experiments()[static_cast<std::size_t>(experiment)];
  for (std::size_t i = 0; i < model.inputs.size(); ++i) {
    std::vector<double> input;
    for (std::size_t k = 0; k < data.time.size(); ++k) input.push_back(data.inputs[i].sample(static_cast<int>(k)));
    CorrelationTest const crossed = input_correlation(residuals, input);
    line.scores.push_back(
        {"input_correlation_p" + (model.inputs.size() > 1 ? "(" + model.inputs[i].name + ")" : std::string()), crossed.p_value});
    if (crossed.fires())
      findings.push_back(
          {Severity::warning, "input_in_residuals",
           fmt::format("past values of input {} still show in the residuals of {} ({} of {} lags outside the 99 % band)",
                       model.inputs[i].name, name, crossed.outside, crossed.correlation.size()),
           "the model misses part of the response to the input"});
  }
}

// values: [D x 1] declared; residuals: all rows of the target.
void check_experiment(ModelTarget const& target, int e, ConstLanes values, LaneArray const& residuals, FitCheck& check) {
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
    std::vector<double> series(experiment.time.size(), std::nan("")), observed, location;
    for (std::size_t r = 0; r < target.residual_places().size(); ++r) {
      auto const [of, at_channel, sample] = target.residual_places()[r];
      if (of != e || at_channel != c || sample < 0) continue;
      auto const i = static_cast<std::size_t>(sample);
      series[i] = residuals(static_cast<int>(r), 0);
      observed.push_back(model.channels[channel].from_si(experiment.measured[channel][i]));
      location.push_back(predicted.values[channel][0][i]);
    }
    if (observed.empty()) continue;
    FitLine line{experiment.name, model.channels[channel].name, model.channels[channel].unit_text(), {}};
    line.scores = {{"nmse", nmse(observed, location)}, {"rmse", rmse(observed, location)}};
    DistributionRow const& noise = *model.channels[channel].noise.row;
    if (explains_nothing(noise, observed, location))
      check.findings.push_back(
          {nmse(observed, location) > useless ? Severity::error : Severity::warning, "worse_than_the_mean",
           fmt::format("{}{} is predicted worse than by its mean: nmse is {:.3g} %, and 100 % is what the mean of the record has",
                       model.channels[channel].name, on(target, e), nmse(observed, location)),
           "the fit explains nothing of this channel: look at units, signs and columns, at the initial values, then at the model"});
    std::vector<std::vector<double>> const arguments = trajectory.noise_arguments(parameters, c);
    SizedResiduals const sized =
        noise.discrete ? pearson(noise, experiment.measured[channel], arguments, series) : scaled(noise, arguments, series);
    test_channel(target, e, c, series, sized, line, check.findings);
    check.lines.push_back(std::move(line));
  }
}

}  // namespace

FitCheck check_residuals(ModelTarget const& target, std::vector<double> const& declared) {
  FitCheck check;
  int const dimension = target.dimension();
  LaneArray values(dimension, 1), theta(dimension, 1), residuals(target.residual_count(), 1);
  for (int p = 0; p < dimension; ++p) values(p, 0) = declared[static_cast<std::size_t>(p)];
  target.unconstrain(values, theta);
  Ledger ledger;
  target.residuals(theta, residuals, ledger);
  for (int e = 0; e < static_cast<int>(target.experiments().size()); ++e) check_experiment(target, e, values, residuals, check);
  return check;
}

Findings check_hierarchy(Model const& model, Draws const& draws, Findings const& found) {
  auto const estimated = [&](NodeId argument) {
    return model.graph.depends(argument, [&](Node const& node) {
      return node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter &&
             model.parameters[static_cast<std::size_t>(node.index)].prior.has_value();
    });
  };
  auto const member = std::find_if(model.parameters.begin(), model.parameters.end(), [&](Parameter const& parameter) {
    // The first argument is where the population lies, what follows is how wide it is.
    return parameter.per_experiment && parameter.prior && !parameter.prior->arguments.empty() &&
           std::any_of(parameter.prior->arguments.begin() + 1, parameter.prior->arguments.end(), estimated);
  });
  if (member == model.parameters.end()) return {};
  if (draws.total() == 1)
    return {{Severity::warning, "optimum_of_hierarchy",
             fmt::format("the density may grow without bound as the spread of `{}` vanishes: an optimum says little about it",
                         member->name),
             "sample it with mh"}};
  bool const unmixed = std::any_of(found.begin(), found.end(), [](Finding const& each) {
    return each.code == "chains_disagree" || each.code == "chains_not_quite_agreed" || each.code == "ess_bulk_low" ||
           each.code == "ess_tail_low";
  });
  if (!unmixed) return {};
  return {{Severity::note, "hierarchy_narrows",
           fmt::format("the spread of `{}` is estimated: where it is small the posterior narrows, and chains pass slowly",
                       member->name),
           fmt::format("write `{}` by standardised members: `parameter z per experiment ~ normal(0, sd = 1)`, `let {} = mean + "
                       "spread*z` (docs/methods/several_experiments.md)",
                       member->name, member->name)}};
}

Findings check_use(Model const& model) {
  Findings findings;
  std::vector<ParameterRole> const roles = parameter_roles(model);
  for (std::size_t p = 0; p < roles.size(); ++p)
    // Terms that vanish over the whole range of an unknown function are another finding.
    if (model.parameters[p].prior && !model.parameters[p].coefficient &&
        (roles[p] == ParameterRole::none || roles[p] == ParameterRole::derived))
      findings.push_back(
          {Severity::warning, "unused_parameter",
           fmt::format("{} enters no equation, no channel and no prior: its posterior is its prior", model.parameters[p].name),
           "remove it, or use it in an equation"});
  return findings;
}

Findings check_input_timing(ModelTarget const& target, Aim aim, Mode const& mode, std::uint64_t seed, Ledger& ledger) {
  Model const& model = target.compiled()->model;
  Findings findings;
  for (int e = 0; e < static_cast<int>(target.experiments().size()); ++e) {
    auto const at = static_cast<std::size_t>(e);
    auto const scored = std::count_if(target.residual_places().begin(), target.residual_places().end(),
                                      [&](auto const& place) { return place.experiment == e && place.sample >= 0; });
    for (std::size_t i = 0; i < model.inputs.size(); ++i) {
      double best_gain = 0, best_shift = 0;
      for (double const shift : {-0.5, 0.5}) {
        std::vector<Experiment> moved = target.experiments();
        moved[at].inputs[i] = moved[at].inputs[i].shifted(shift);
        ModelTarget const other(target.compiled(), target.space(), std::move(moved), target.options());
        std::vector<Mode> const refitted = refit(other, aim, {mode}, seed, ledger);
        double const gain = refitted.front().log_density - mode.log_density;
        if (gain > best_gain) best_gain = gain, best_shift = shift;
      }
      if (best_gain <= gain_at_least || best_gain <= gain_per_sample * static_cast<double>(scored)) continue;
      findings.push_back(
          {Severity::warning, "input_timing",
           fmt::format("input {}{} half a sample {} would fit much better (log posterior up by {:.0f} over {} samples)",
                       model.inputs[i].name, on(target, e), best_shift > 0 ? "later" : "earlier", best_gain, scored),
           "check the rule between input samples (hold zero_order, linear, cubic, band_limited) and the delay of the recording"});
    }
  }
  return findings;
}

}  // namespace sysid
