// The solver of fits whose filter may step exactly.
#pragma once
#include "app/session/session.hpp"

namespace sysid {

/// The task with an exact solver where it states none, its model has random states, and its equations and data allow it: then mean
/// and covariance make no error between samples, and one step of any length costs the same.
FitTask with_exact_steps(Session& session, FitTask what);
FitTask with_exact_steps(FitTask what, Model const& model, std::vector<ExperimentData> const& data);

/// The solver of a prediction: as the fit had it, but an exact one that the task did not state gives way to adaptive steps where
/// the data that are predicted do not suit it. fit: with the errors that inputs have there.
SolverSettings solver_along(Session& session, FitTask const& fit, SolverSettings const& fitted, PredictTask const& what);

}  // namespace sysid
