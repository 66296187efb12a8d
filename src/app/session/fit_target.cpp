// Options of a target from a fit task.
#include "app/session/fit_target.hpp"

namespace sysid {

int start_rows(StartRule start) { return start.kind == StartRule::Kind::estimated ? start.rows : 0; }

TargetOptions fit_target_options(Session const& session, FitTask const& what, SolverSettings const& solver,
                                 ExecutionOptions const& execution) {
  TargetOptions options;
  options.solver = solver;
  options.start_rows = start_rows(what.start);
  options.execution = execution;
  options.describe = [&session, model = what.model](NodeId node, Graph const& graph) {
    return session.describe(model, graph, node);
  };
  return options;
}

std::unique_ptr<ModelTarget> make_fit_target(Session const& session, FitTask const& what,
                                             std::shared_ptr<CompiledModel const> compiled,
                                             std::shared_ptr<ParameterSpace const> space, std::vector<Experiment> experiments,
                                             SolverSettings const& solver, ExecutionOptions const& execution) {
  return std::make_unique<ModelTarget>(std::move(compiled), std::move(space), std::move(experiments),
                                       fit_target_options(session, what, solver, execution));
}

}  // namespace sysid
