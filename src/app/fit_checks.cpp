// Residual tests per channel and the timing of the input.
#include "app/fit_checks.hpp"

#include <fmt/format.h>

#include <cmath>

#include "inference/refit.hpp"
#include "inference/residual_tests.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {
namespace {

constexpr double gain_per_sample = 0.2;  // nats
constexpr double gain_at_least = 20;

void test_channel(ModelTarget const& target, int channel, std::vector<double> const& residuals, FitCheck& check) {
  Model const& model = target.compiled().model;
  std::string const& name = model.channels[static_cast<std::size_t>(channel)].name;
  std::string const suffix = model.channels.size() > 1 ? "(" + name + ")" : "";
  ChiSquaredTest const size = chi_squared(residuals);
  check.scores.push_back({"chi_squared_per_sample" + suffix, size.per_sample});
  if (size.fires())
    check.findings.push_back(
        {Severity::error, "noise_size",
         fmt::format("residuals of {} are not of the stated size: chi-squared per sample is {:.3g}, expected {:.2f} to {:.2f}",
                     name, size.per_sample, size.low, size.high),
         size.per_sample > 1
             ? "the noise is larger than stated, or the model misses something: estimate the noise, then look at the residuals"
             : "the stated noise is too large: estimate it"});
  CorrelationTest const white = whiteness(residuals);
  check.scores.push_back({"whiteness_p" + suffix, white.p_value});
  if (white.fires())
    check.findings.push_back({Severity::warning, "residuals_not_white",
                              fmt::format("residuals of {} are correlated in time ({} of {} lags outside the 99 % band)", name,
                                          white.outside, white.correlation.size()),
                              "the model misses dynamics or the noise is coloured: posterior widths are too small"});
  Experiment const& experiment = target.experiment();
  for (std::size_t i = 0; i < model.inputs.size(); ++i) {
    std::vector<double> input;
    for (std::size_t k = 0; k < experiment.time.size(); ++k) input.push_back(experiment.inputs[i].sample(static_cast<int>(k)));
    CorrelationTest const crossed = input_correlation(residuals, input);
    check.scores.push_back(
        {fmt::format("input_correlation_p{}",
                     model.inputs.size() + model.channels.size() > 2 ? fmt::format("({}, {})", name, model.inputs[i].name) : ""),
         crossed.p_value});
    if (crossed.fires())
      check.findings.push_back(
          {Severity::warning, "input_in_residuals",
           fmt::format("past values of input {} still show in the residuals of {} ({} of {} lags outside the 99 % band)",
                       model.inputs[i].name, name, crossed.outside, crossed.correlation.size()),
           "the model misses part of the response to the input"});
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
  Experiment const& experiment = target.experiment();
  Model const& model = target.compiled().model;
  Trajectory const trajectory(std::make_shared<CompiledModel const>(target.compiled()), experiment, target.options().solver,
                              target.options().start_rows, target.options().execution);
  Trajectory::Result const predicted = trajectory.run(values, {});
  for (int c = 0; c < static_cast<int>(model.channels.size()); ++c) {
    auto const channel = static_cast<std::size_t>(c);
    if (experiment.measured[channel].empty()) continue;
    std::vector<double> series(experiment.time.size(), std::nan(""));
    std::vector<double> observed, location;
    double square = 0;
    for (std::size_t r = 0; r < target.residual_places().size(); ++r) {
      auto const [of, sample] = target.residual_places()[r];
      if (of != c || sample < 0) continue;
      auto const i = static_cast<std::size_t>(sample);
      series[i] = residuals(static_cast<int>(r), 0);
      observed.push_back(model.channels[channel].from_si(experiment.measured[channel][i]));
      location.push_back(predicted.values[channel][0][i]);
      square += (observed.back() - location.back()) * (observed.back() - location.back());
    }
    if (observed.empty()) continue;
    std::string const suffix = model.channels.size() > 1 ? "(" + model.channels[channel].name + ")" : "";
    check.scores.push_back({"nmse" + suffix, nmse(observed, location)});
    check.scores.push_back({"rmse" + suffix, std::sqrt(square / static_cast<double>(observed.size()))});
    test_channel(target, c, series, check);
  }
  return check;
}

Findings check_input_timing(ModelTarget const& target, Mode const& mode, std::uint64_t seed, Ledger& ledger) {
  Model const& model = target.compiled().model;
  int const scored = target.residual_count() - static_cast<int>(model.channels.size());
  Findings findings;
  for (std::size_t i = 0; i < model.inputs.size(); ++i) {
    double best_gain = 0, best_shift = 0;
    for (double const shift : {-0.5, 0.5}) {
      Experiment moved = target.experiment();
      moved.inputs[i] = moved.inputs[i].shifted(shift);
      ModelTarget const other(std::make_shared<CompiledModel const>(target.compiled()), std::move(moved), target.options());
      std::vector<Mode> const refitted = refit(other, {mode}, seed, ledger);
      double const gain = refitted.front().log_density - mode.log_density;
      if (gain > best_gain) best_gain = gain, best_shift = shift;
    }
    if (best_gain <= gain_at_least || best_gain <= gain_per_sample * scored) continue;
    findings.push_back(
        {Severity::warning, "input_timing",
         fmt::format("input {} half a sample {} would fit much better (log posterior up by {:.0f} over {} samples)",
                     model.inputs[i].name, best_shift > 0 ? "later" : "earlier", best_gain, scored),
         "check the rule between input samples (hold zero_order, linear, cubic, band_limited) and the delay of the recording"});
  }
  return findings;
}

}  // namespace sysid
