// Bands with the times that they are of.
#include "app/fit/smoothed_states.hpp"

#include "diagnostics/bands.hpp"

namespace sysid {

Prediction smoothed_states(std::shared_ptr<SmoothingProgram const> const& smoothing, Experiment const& experiment,
                           SolverSettings const& solver, int start_rows, ExecutionOptions const& options, ConstLanes parameters) {
  Smoother const smoother(smoothing, experiment, solver, start_rows, options);
  std::vector<Band> bands = pooled_states(smoother, parameters);
  Prediction states = record_along(experiment, smoothing->compiled->model);
  states.inputs.clear();
  states.smoothed = true;
  for (std::size_t q = 0; q < bands.size(); ++q) {
    SmoothedName const& of = smoother.quantities()[q];
    PredictedQuantity quantity{of.name, of.unit, std::move(bands[q]), {}, {}};
    quantity.average = of.average;
    states.quantities.push_back(std::move(quantity));
  }
  return states;
}

}  // namespace sysid
