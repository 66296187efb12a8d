// Whether the unknown functions of an equation are read where their finite sums stand for something.
#pragma once
#include "inference/finding.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {

/// outside_range where a function was read beyond its range along an experiment, by any of up to 100 parameter vectors. A vector
/// that the simulation fails for says nothing. parameters: of the model, SI [parameters x W].
Findings check_ranges(Model const& model, Experiment const& experiment, SolverSettings const& solver, int start_rows,
                      ConstLanes parameters, ExecutionOptions const& options);

}  // namespace sysid
