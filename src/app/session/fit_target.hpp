// The target of a fit task, built in the same way for sampling and for `check`.
#pragma once
#include <memory>

#include "app/session/session.hpp"
#include "likelihood/model_target.hpp"

namespace sysid {

/// Rows that estimate the start state; 0: the model's own start.
int start_rows(StartRule start);

TargetOptions fit_target_options(Session const& session, FitTask const& what, SolverSettings const& solver,
                                 ExecutionOptions const& execution);

std::unique_ptr<ModelTarget> make_fit_target(Session const& session, FitTask const& what,
                                             std::shared_ptr<CompiledModel const> compiled,
                                             std::shared_ptr<ParameterSpace const> space, std::vector<Experiment> experiments,
                                             SolverSettings const& solver, ExecutionOptions const& execution);

}  // namespace sysid
