// How a fit is integrated for tracking, and where its states are before the first row.
#pragma once
#include "tracking/tracker.hpp"

namespace sysid {

/// A state somewhere along a record: the mean and four times the covariance of what a simulation with the mean parameters passes
/// through. first: the states at its beginning. The rows are filtered where `corrects`.
StatePrior states_along(TrackedProgram const& program, SolverSettings const& solver, ExecutionOptions const& execution,
                        Experiment const& experiment, StatePrior const& first, TrackedPrior const& parameters, bool corrects);

/// A solver with fixed steps, fine enough that halving them moves the innovations along the experiment's first rows by less than a
/// hundredth of their sds; UserError where neither 64 steps nor twice those of `solver` are enough.
SolverSettings tracking_solver(TrackedProgram const& program, SolverSettings solver, ExecutionOptions const& execution,
                               Experiment const& experiment, StatePrior const& first, TrackedPrior const& parameters);

/// The method that tracking integrates with, where the solver of a fit is `solver`: itself if its steps are fixed and it is no
/// exact one, which needs equations that are linear in the states and the parameters; else rk4.
SolverSettings steps_for_tracking(SolverSettings const& solver);

}  // namespace sysid
