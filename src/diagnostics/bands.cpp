// Trajectories to bands, quantity by quantity.
#include "diagnostics/bands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnostics/scores.hpp"
#include "diagnostics/verdict.hpp"
#include "likelihood/smoothing/pooled_states.hpp"
#include "model/simulated_parameters.hpp"
#include "result/experiment_words.hpp"

namespace sysid {

Prediction record_along(Experiment const& experiment, Model const& model) {
  Prediction prediction;
  prediction.experiment = experiment.name;
  prediction.time = experiment.time;
  if (experiment.time_unit) {
    prediction.time_unit = experiment.time_unit->text;
    prediction.time_scale = experiment.time_unit->scale;
  }
  prediction.rows = model.dynamics == Dynamics::none;
  if (prediction.rows)  // of any order: shown as they stand in the file
    for (std::size_t i = 0; i < prediction.time.size(); ++i) prediction.time[i] = experiment.first_row + static_cast<double>(i);
  prediction.scored = experiment.scored;
  for (std::size_t k = 0; k < model.inputs.size(); ++k) {
    Quantity const& input = model.inputs[k];
    PredictedInput driven{input.name, input.unit_text(), {}};
    for (int i = 0; i < static_cast<int>(experiment.time.size()); ++i)
      driven.values.push_back(input.from_si(experiment.inputs[k].sample(i)));
    prediction.inputs.push_back(std::move(driven));
  }
  return prediction;
}

namespace {

/// Of normal distributions about trajectories, one for each: the moments and quantiles of their mixture.
Band normal_band(std::vector<std::vector<double>> const& means, std::vector<std::vector<double>> const& sds) {
  Band out = band(means);
  std::vector<double> centres, widths;
  for (std::size_t i = 0; i < out.mean.size(); ++i) {
    centres.clear();
    widths.clear();
    for (std::size_t d = 0; d < means.size(); ++d) {
      if (i >= means[d].size() || !std::isfinite(means[d][i]) || !std::isfinite(sds[d][i])) continue;
      centres.push_back(means[d][i]);
      widths.push_back(sds[d][i]);
    }
    if (centres.empty() || !std::isfinite(out.mean[i])) continue;
    NormalMixture const mixture = normal_mixture(centres, widths);
    out.mean[i] = mixture.mean;
    out.sd[i] = mixture.sd;
    out.lower[i] = mixture.lower;
    out.upper[i] = mixture.upper;
  }
  return out;
}

/// Of one draw of the noise about each trajectory or several, which count as one.
Band noisy_band(std::vector<std::vector<double>> const& noisy, std::size_t trajectories) {
  Band out = band(noisy);
  int const times = std::max(1, static_cast<int>(noisy.size() / std::max<std::size_t>(1, trajectories)));
  out.draws /= times;
  out.excluded = (out.excluded + times - 1) / times;
  return out;
}

}  // namespace

Prediction bands_along(std::span<TrajectoryQuantity const> quantities, Trajectory::Result const& result,
                       Experiment const& experiment, Model const& model) {
  Prediction prediction = record_along(experiment, model);
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    TrajectoryQuantity const& quantity = quantities[q];
    // A state that a channel of its name observes is shown once, as the channel.
    bool const shown = quantity.channel < 0 && std::any_of(model.channels.begin(), model.channels.end(),
                                                           [&](Channel const& channel) { return channel.name == quantity.name; });
    if (shown) continue;
    PredictedQuantity predicted;
    predicted.name = quantity.name;
    predicted.unit = quantity.unit;
    bool const random = result.is_random(q);
    predicted.response = random ? normal_band(result.values[q], result.spread[q]) : band(result.values[q]);
    if (quantity.channel >= 0) {
      auto const channel = static_cast<std::size_t>(quantity.channel);
      predicted.logarithmic = multiplies(*model.channels[channel].noise.row);
      if (channel < result.noisy_spread.size() && !result.noisy_spread[channel].empty())
        predicted.noisy = normal_band(result.values[q], result.noisy_spread[channel]);
      else if (result.noisy[channel].size() > 1)
        predicted.noisy = noisy_band(result.noisy[channel], result.values[q].size());  // one trajectory has no width
      for (double const si : experiment.measured[channel]) predicted.measured.push_back(model.channels[channel].from_si(si));
    }
    prediction.quantities.push_back(std::move(predicted));
  }
  return prediction;
}

Findings leave_out_noise(Model const& model, Prediction& prediction) {
  std::vector<std::string> const names = derived_from_noise(model);
  std::vector<std::string> gone;
  std::erase_if(prediction.quantities, [&](PredictedQuantity const& each) {
    bool const reads = each.measured.empty() && std::find(names.begin(), names.end(), each.name) != names.end();
    if (reads) gone.push_back(each.name);
    return reads;
  });
  if (gone.empty()) return {};
  std::string const quoted = fmt::format("`{}`", fmt::join(gone, "`, `"));
  return {{FindingCode::reads_noise, Severity::note, std::move(gone),
           fmt::format("left out, because they depend on the noise, which a selection by distance does not estimate: {}", quoted),
           ""}};
}

Findings band_findings(Prediction const& prediction, int failed, int failed_elsewhere, bool several) {
  Findings findings;
  for (PredictedQuantity const& quantity : prediction.quantities) {
    bool const measured = !quantity.measured.empty();
    Band const& widest = quantity.noisy.excluded > quantity.response.excluded ? quantity.noisy : quantity.response;
    int const excluded = widest.excluded - (measured ? failed : failed_elsewhere);
    if (excluded <= 0) continue;
    Severity severity = failure_severity(static_cast<std::uint64_t>(excluded), static_cast<std::uint64_t>(widest.draws));
    if (severity == Severity::error && !measured) severity = Severity::warning;  // the others are what they are
    findings.push_back({FindingCode::undefined_in_band,
                        severity,
                        {quantity.name, prediction.experiment},
                        fmt::format("{}{} is undefined somewhere along {} of {} trajectories; its band contains only the others",
                                    quantity.name, on_experiment(prediction.experiment, several), excluded, widest.draws),
                        "check for a root or a logarithm of a negative number, or a division by zero"});
  }
  return findings;
}

StreamKey prediction_noise(std::uint64_t seed, int experiment) {
  return {seed, Purpose::prediction, static_cast<std::uint64_t>(experiment) << 32, 0};
}

}  // namespace sysid
