// A solver in results and checkpoints: written with all its settings, read back as it was.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "result/report.hpp"
#include "solver/solver.hpp"

namespace sysid {

/// Adds `solver` and the settings of its method; `as_model` where it is set.
void add_solver(SolverSettings const& solver, Facts& facts);

/// From an object with the names that `add_solver` writes; what is not there has its default. nlohmann::json::exception where
/// nothing can be integrated with it.
SolverSettings read_solver(nlohmann::json const& settings);
/// The same names as an object.
nlohmann::json write_solver(SolverSettings const& solver);

}  // namespace sysid
