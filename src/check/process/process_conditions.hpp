// What a process is known to be at points: `zero_at` and `flat_at` beside its covariance.
#pragma once
#include <vector>

#include "check/process/process_covariance.hpp"

namespace sysid {

/// Into process.conditions, in SI; kernels and inputs of the process are read. A point is a list with one coordinate for each
/// declared input, of one input the coordinate itself; of an input that stands for several lags one for all of them or a list.
/// Several points are a list of points. False after a diagnostic.
bool read_conditions(Scope& scope, ast::ProcessDefinition const& definition, ProcessArguments const& arguments,
                     std::vector<std::vector<int>> const& columns, Process& process);

}  // namespace sysid
