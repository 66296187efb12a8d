// Trajectories to bands, quantity by quantity.
#include "app/bands.hpp"

#include <algorithm>

namespace sysid {

Prediction bands_along(Trajectory const& trajectory, Trajectory::Result const& result, Experiment const& experiment,
                       Model const& model) {
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
  for (std::size_t q = 0; q < trajectory.quantities().size(); ++q) {
    TrajectoryQuantity const& quantity = trajectory.quantities()[q];
    // A state that a channel of its name observes is shown once, as the channel.
    bool const shown = quantity.channel < 0 && std::any_of(model.channels.begin(), model.channels.end(),
                                                           [&](Channel const& channel) { return channel.name == quantity.name; });
    if (shown) continue;
    PredictedQuantity predicted;
    predicted.name = quantity.name;
    predicted.unit = quantity.unit;
    predicted.response = band(result.values[q]);
    if (quantity.channel >= 0) {
      auto const channel = static_cast<std::size_t>(quantity.channel);
      if (result.noisy[channel].size() > 1) predicted.noisy = band(result.noisy[channel]);  // one trajectory has no width
      for (double const si : experiment.measured[channel]) predicted.measured.push_back(model.channels[channel].from_si(si));
    }
    prediction.quantities.push_back(std::move(predicted));
  }
  return prediction;
}

StreamKey prediction_noise(std::uint64_t seed, int experiment) {
  return {seed, Purpose::prediction, static_cast<std::uint64_t>(experiment) << 32, 0};
}

}  // namespace sysid
