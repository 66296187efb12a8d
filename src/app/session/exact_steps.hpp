// The solver of fits whose equations are linear in their states, where the task states none.
#pragma once
#include <string>
#include <vector>

#include "app/session/session.hpp"

namespace sysid {

struct SuitedTask {
  FitTask task;
  /// The share of the prior on which the steps of the task's own solver grow without bound; 0 where that is not why another solver
  /// was taken.
  double growing = 0;
};

/// The task with an exact solver where it states none, its equations and data allow it, and
///
///   its model has random states and its samples are equally far apart: then mean and covariance make no error between samples, and
///   one step of any length costs the same; or
///   the steps that the task would begin with grow without bound over a notable part of the prior, where the motion does not.
SuitedTask with_exact_steps(Session& session, FitTask what);
SuitedTask with_exact_steps(FitTask what, Model const& model, std::vector<ExperimentData> const& data);

/// Why the steps of a task or candidate are exact, in a line; given: the solver that its steps would have begun with.
std::string exact_notice(std::string const& name, SolverSettings const& given, SuitedTask const& suited);

/// The solver of a prediction: as the fit had it, but an exact one that the task did not state gives way to adaptive steps where
/// the data that are predicted, `along`, do not suit it. fit: with the errors that inputs have there.
SolverSettings solver_along(Session& session, FitTask const& fit, SolverSettings const& fitted,
                            std::vector<ExperimentUse> const& along, PredictTask const& what);

}  // namespace sysid
