// What a fit found of the unknown functions in its equations, and whether their finite sums can be believed.
#pragma once
#include <cstdint>
#include <vector>

#include "inference/backend.hpp"
#include "inference/finding.hpp"
#include "likelihood/parameter_space.hpp"
#include "likelihood/trajectory.hpp"
#include "report/function.hpp"

namespace sysid {

/// Parameters of a fit as columns of declared values [D x <= 200]: draws of it, of an optimum those of its Laplace approximation.
LaneArray function_draws(Target const& target, FitResult const& result, std::uint64_t seed);

/// Every unknown function over its range. parameters: of the model [parameters x W], SI.
std::vector<FunctionReport> unknown_functions(Model const& model, ConstLanes parameters);

/// basis_inaccurate where a sum, with the mean of the hyper-parameters, is not the process that it stands for.
Findings check_expansions(Model const& model, ConstLanes parameters);

/// outside_range where a function was read beyond its range along an experiment. parameters: of the model [parameters x 1], SI.
Findings check_ranges(Model const& model, Experiment const& experiment, SolverSettings const& solver, int start_rows,
                      ConstLanes parameters, ExecutionOptions const& options);

}  // namespace sysid
