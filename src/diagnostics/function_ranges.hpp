// The arguments at which the unknown functions of an equation are used, and whether their finite sums are valid there.
#pragma once
#include "likelihood/trajectory.hpp"
#include "result/finding.hpp"
#include "result/function.hpp"

namespace sysid {

/// outside_range where a function was read beyond its range along an experiment, by any of up to 100 parameter vectors. A vector
/// that the simulation fails for says nothing. parameters: of the model, SI [parameters x W].
Findings check_ranges(Model const& model, Experiment const& experiment, SolverSettings const& solver, int start_rows,
                      ConstLanes parameters, ExecutionOptions const& options);

/// Runs along one experiment. parameters: of the model, SI [parameters x W].
struct RunsAlong {
  Experiment experiment;
  int start_rows = 0;
  LaneArray parameters;
};

/// far_outside where a function is read inside its range, but along `predicted` farther from what the scored rows of `fitted`
/// visited than a tenth of the width of that: in the median of up to 20 runs each. There its values come from the prior.
Findings check_reach(Model const& model, std::vector<RunsAlong> const& fitted, RunsAlong const& predicted,
                     SolverSettings const& solver, ExecutionOptions const& options);

/// Adds the scored samples of an experiment to the visits of `functions`, which are those of the model's expansions in their order.
void add_visits(Model const& model, Experiment const& experiment, SolverSettings const& solver, int start_rows,
                ConstLanes parameters, ExecutionOptions const& options, std::vector<FunctionReport>& functions);

}  // namespace sysid
