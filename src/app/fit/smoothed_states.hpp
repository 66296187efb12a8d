// Random states and disturbances of a fit, along each of its records.
#pragma once
#include "likelihood/smoothing/pooled_states.hpp"
#include "result/prediction.hpp"

namespace sysid {

/// parameters: of the model in that experiment, SI [parameters x draws]. start_rows, options: as of a Smoother.
Prediction smoothed_states(std::shared_ptr<SmoothingProgram const> const& smoothing, Experiment const& experiment,
                           SolverSettings const& solver, int start_rows, ExecutionOptions const& options, ConstLanes parameters);

}  // namespace sysid
